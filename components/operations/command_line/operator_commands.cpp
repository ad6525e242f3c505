#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>

#include "foundation/grid/map_file.hpp"
#include "idl/topics.hpp"
#include "mapping/map_server/core/map_from_log.hpp"
#include "navigation/navigator/core/locations.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;
using namespace usher_msgs::msg;

constexpr auto kRepeat = milliseconds(200);
constexpr auto kPatience = std::chrono::seconds(3);
constexpr auto kGone = std::chrono::seconds(5);  // longer than the launcher needs to restart it
constexpr const char* kClient = kOperatorName;

std::atomic<bool> stop_asked{false};

int fail(const std::string& message) {
  std::cerr << "usher: " << message << "\n";
  return 1;
}

int ask_supervisor(std::uint32_t domain, std::uint8_t command, const std::string& done) {
  auto observer = Observer::create(reach_robot(kClient, domain));
  if (!observer) return fail(observer.error());
  if (const auto told = tell_supervisor(**observer, command); !told) return fail(told.error());
  std::cout << done << "\n";
  return 0;
}

struct GoalArguments {
  std::string location;
  std::vector<double> pose;
  double max_speed = 0.0;
  bool no_wait = false;
};

/// What the running navigator knows.
Result<navigator::Locations> locations_of(Observer& observer, std::uint32_t domain) {
  auto reader = observer.reader(topics::kLocations);
  if (!reader) return Error{reader.error()};
  const auto message = reader->take(kPatience);
  if (!message) return Error{nobody_there("navigator", domain)};
  std::vector<navigator::Location> locations;
  for (const auto& location : message->locations()) {
    const auto pose = wire::to_planar(location.pose());
    if (pose) locations.push_back({location.name(), location.title(), *pose});
  }
  return navigator::Locations::create(std::move(locations));
}

int list(const navigator::Locations& locations) {
  Table table({"location", "title", "x", "y", "yaw"});
  for (const auto& location : locations.all()) {
    table.add({location.name, location.title, format("%.2f", location.pose.x),
               format("%.2f", location.pose.y), format("%.2f", location.pose.yaw)});
  }
  std::cout << table.text();
  return 0;
}

/// What the navigator would refuse, before anybody is asked for anything: what runs goes on.
Status judge(const GoalArguments& arguments, const navigator::Locations& locations) {
  if (!std::isfinite(arguments.max_speed) || arguments.max_speed < 0.0)
    return Error{"--max-speed must be 0 or more, got " + format("%g m/s", arguments.max_speed)};
  if (!std::ranges::all_of(arguments.pose, [](double value) { return std::isfinite(value); }))
    return Error{"--pose must be finite"};
  if (arguments.location.empty()) return {};
  const auto found = locations.find(arguments.location);
  if (found) return {};
  std::string names;
  for (const auto& location : locations.all()) names += (names.empty() ? "" : " ") + location.name;
  return Error{found.error() + "\nlocations: " + names};
}

/// How the robot drives: on a terminal one line that is rewritten, else a line now and then.
class ProgressLine {
 public:
  void show(const NavigateStatus& status) {
    const auto now = std::chrono::steady_clock::now();
    if (!terminal_ && now - shown_ < kEvery) return;
    shown_ = now;
    std::cout << (terminal_ ? "\r" : "") << format("%3.0f %%", status.progress() * 100.0) << "  "
              << format("%5.1f m left", status.remaining()) << "  "
              << (std::isfinite(status.eta()) ? format("%4.0f s", status.eta()) : "   -")
              << (status.reason().empty() ? "" : "  " + status.reason())
              << (terminal_ ? "\033[K" : "\n") << std::flush;
  }
  /// What follows begins a line of its own.
  void end() const { std::cout << (terminal_ ? "\n" : "") << std::flush; }

 private:
  static constexpr auto kEvery = std::chrono::seconds(5);
  bool terminal_ = isatty(STDOUT_FILENO) != 0;
  std::chrono::steady_clock::time_point shown_{};
};

/// Repeats the cancellation until the navigator has answered. Once it took the goal, a status of
/// another one is an answer too.
Status cancel(Observer& observer, Observer::Reader<NavigateStatus>& reader, std::uint64_t id,
              bool accepted) {
  auto writer = observer.writer(topics::kNavigateCancel);
  if (!writer) return Error{writer.error()};
  GoalCancel message;
  message.id(id);
  message.client(kClient);
  for (int tries = 0; tries < 15; ++tries) {
    writer->write(message);
    const auto until = std::chrono::steady_clock::now() + kRepeat;
    while (std::chrono::steady_clock::now() < until) {
      const auto status = reader.take(milliseconds(50));
      if (!status) continue;
      if (status->id() == id ? status->state() >= GoalStatus_Constants::STATE_SUCCEEDED : accepted)
        return {};
    }
  }
  return Error{"the navigator did not cancel the goal within 3 s"};
}

NavigateGoal goal_from(const GoalArguments& arguments) {
  NavigateGoal goal;
  goal.id(fresh_id());
  goal.client(kClient);
  goal.location(arguments.location);
  goal.max_speed(static_cast<float>(arguments.max_speed));
  goal.pose().header().frame_id(frames::kMap);
  if (!arguments.pose.empty()) {
    goal.pose().pose(
        wire::to_message(geometry::Pose2{arguments.pose[0], arguments.pose[1], arguments.pose[2]}));
  }
  return goal;
}

/// Notices that the supervisor will let the navigation drive no further: after a latched fault or
/// manual driving nobody starts it again.
class SupervisorWatch {
 public:
  explicit SupervisorWatch(Observer::Reader<SupervisorStatus>& reader) : reader_(reader) {}

  /// Why, once that has been so for longer than it takes a goal to end.
  std::optional<std::string> ended_navigation() {
    using namespace SupervisorStatus_Constants;
    const auto now = std::chrono::steady_clock::now();
    while (const auto status = reader_.take(milliseconds(0))) {
      const bool over = status->state() == STATE_FAULT || status->state() == STATE_MANUAL ||
                        status->state() == STATE_INTERACTION;
      if (!over) over_since_.reset();
      if (over && !over_since_) over_since_ = now;
      if (status->state() == STATE_FAULT) why_ = status->reason();
      if (status->state() == STATE_MANUAL) why_ = "driven by hand";
      // Who has answered nobody has forgotten our request, too.
      if (status->last_request() == 0) restarted_ = true;
      ready_ = status->state() == STATE_INTERACTION;
    }
    if (!over_since_ || now - *over_since_ < kOver) return std::nullopt;
    return "the supervisor ended the navigation" + (why_.empty() ? "" : ": " + why_);
  }
  /// Once after each restart of the supervisor: it takes requests again, and knows of none.
  bool forgot_navigation() {
    if (!restarted_ || !ready_ || !why_.empty()) return false;
    restarted_ = false;
    over_since_.reset();
    return true;
  }

 private:
  static constexpr auto kOver = std::chrono::seconds(2);
  Observer::Reader<SupervisorStatus>& reader_;
  std::optional<std::chrono::steady_clock::time_point> over_since_;
  std::string why_;
  bool restarted_ = false, ready_ = false;
};

/// Lets the navigation drive.
Status start_navigation(Observer& observer, const GoalArguments& arguments) {
  using namespace SupervisorRequest_Constants;
  const std::string name = arguments.location.empty() ? "pose" : arguments.location;
  for (const auto command : {COMMAND_NAVIGATION_START, COMMAND_NAVIGATION_GO}) {
    if (auto told = tell_supervisor(observer, command, name); !told) return told;
  }
  return {};
}

enum class Outcome { kUnderWay, kArrived, kFailed, kReplaced };

/// Sends the goal and watches it to its end; Ctrl-C cancels it.
Outcome pursue(Observer& observer, std::uint32_t domain, const GoalArguments& arguments) {
  const auto failed = [](const std::string& reason) {
    fail(reason);
    return Outcome::kFailed;
  };
  auto writer = observer.writer(topics::kNavigateGoal);
  auto reader = observer.reader(topics::kNavigateStatus);
  auto guard = observer.reader(topics::kSupervisorStatus);
  if (!writer) return failed(writer.error());
  if (!guard) return failed(guard.error());
  if (!reader) return failed(reader.error());
  if (!writer->wait_for_readers(1, kPatience)) return failed(nobody_there("navigator", domain));

  const NavigateGoal goal = goal_from(arguments);
  using Clock = std::chrono::steady_clock;
  Clock::time_point told{}, heard = Clock::now(), given = heard;
  bool accepted = false;
  SupervisorWatch supervisor(*guard);
  ProgressLine progress;
  for (;;) {
    if (stop_asked) {
      const auto cancelled = cancel(observer, *reader, goal.id(), accepted);
      progress.end();
      return failed(cancelled ? "cancelled" : cancelled.error());
    }
    if (!accepted && Clock::now() - given > kPatience)
      return failed("the navigator did not take the goal within 3 s");
    if (!accepted && Clock::now() - told > kRepeat) {
      writer->write(goal);
      told = Clock::now();
    }
    const auto status = reader->take(milliseconds(100));
    if (status) heard = Clock::now();
    if (Clock::now() - heard > kGone) {
      progress.end();
      return failed(
          "the navigator has been silent for 5 s; what it did with the goal is not known");
    }
    const auto why = supervisor.ended_navigation();
    if (accepted && supervisor.forgot_navigation()) {
      if (const auto again = start_navigation(observer, arguments); !again) {
        progress.end();
        return failed(again.error());
      }
    } else if (accepted && why) {
      const auto cancelled = cancel(observer, *reader, goal.id(), accepted);
      progress.end();
      return failed(*why + (cancelled ? "" : "; " + cancelled.error()));
    }
    if (!status) continue;
    const bool runs = status->state() == GoalStatus_Constants::STATE_ACTIVE ||
                      status->state() == GoalStatus_Constants::STATE_WAITING;
    if (status->id() != goal.id()) {
      if (accepted && status->id() == 0) {  // restarted: it has forgotten everything
        accepted = false;
        given = Clock::now();
      }
      if (!accepted || !runs) continue;
      progress.end();
      fail("another goal took its place");
      return Outcome::kReplaced;
    }
    accepted = true;
    if (arguments.no_wait && runs) return Outcome::kUnderWay;
    progress.show(*status);
    if (runs) continue;
    progress.end();
    if (status->state() == GoalStatus_Constants::STATE_SUCCEEDED) {
      std::cout << "arrived\n";
      return Outcome::kArrived;
    }
    fail(status->reason());
    return status->state() == GoalStatus_Constants::STATE_REPLACED ? Outcome::kReplaced
                                                                   : Outcome::kFailed;
  }
}

/// The supervisor lets the navigation drive from the start to the end of a goal.
int go(std::uint32_t domain, const GoalArguments& arguments) {
  using namespace SupervisorRequest_Constants;
  auto observer = Observer::create(reach_robot(kClient, domain));
  if (!observer) return fail(observer.error());
  const auto locations = locations_of(**observer, domain);
  if (!locations) return fail(locations.error());
  if (arguments.location.empty() && arguments.pose.empty()) return list(*locations);
  if (const auto sound = judge(arguments, *locations); !sound) return fail(sound.error());
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  if (const auto told = start_navigation(**observer, arguments); !told) return fail(told.error());
  const Outcome outcome = pursue(**observer, domain, arguments);
  if (outcome == Outcome::kFailed) {  // one that was replaced leaves the navigation to the other
    if (const auto told = tell_supervisor(**observer, COMMAND_NAVIGATION_END); !told) {
      std::cerr << "usher: the navigation could not be ended: " << told.error() << "\n";
    }
  }
  return outcome == Outcome::kUnderWay || outcome == Outcome::kArrived ? 0 : 1;
}

int save_map(std::uint32_t domain, const std::string& path) {
  auto observer = Observer::create(reach_robot(kClient, domain));
  if (!observer) return fail(observer.error());
  auto reader = (*observer)->reader(topics::kMap);
  if (!reader) return fail(reader.error());
  const auto message = reader->take(std::chrono::seconds(5));
  if (!message) return fail(nobody_there("map", domain));
  const auto map = wire::from_message(*message);
  if (!map) return fail(map.error());
  if (const auto saved = grid::save_map(*map, path); !saved) return fail(saved.error());
  std::cout << "saved " << map->width() << " x " << map->height() << " cells to " << path << "\n";
  return 0;
}

struct MapFromLogArguments {
  std::string log;
  std::string reference;
  std::string out;
  std::size_t every = 1;
  double resolution = 0.05;
};

int map_from_log(const MapFromLogArguments& arguments) {
  const auto scans = map_server::read_carmen_log(arguments.log);
  if (!scans) return fail(scans.error());
  const auto reference = map_server::read_reference_poses(arguments.reference);
  if (!reference) return fail(reference.error());
  const auto map = map_server::map_from_log(*scans, *reference, arguments.every,
                                            {.resolution = arguments.resolution});
  if (!map) return fail(arguments.log + ": " + map.error());
  if (const auto saved = grid::save_map(*map, arguments.out); !saved) return fail(saved.error());
  std::cout << "saved " << map->width() << " x " << map->height() << " cells of "
            << (scans->size() + arguments.every - 1) / arguments.every << " of " << scans->size()
            << " scans to " << arguments.out << "\n";
  return 0;
}

}  // namespace

void add_operator_commands(CLI::App& app, int& exit_code) {
  using namespace SupervisorRequest_Constants;
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  const auto with_domain = [domain](CLI::App* command) {
    add_domain_option(*command, *domain);
    return command;
  };

  auto arguments = std::make_shared<GoalArguments>();
  auto* goto_command = with_domain(app.add_subcommand(
      "goto", "Send the robot to a location or a pose; without either, list the locations"));
  goto_command->add_option("location", arguments->location, "Name of a known location");
  goto_command->add_option("--pose", arguments->pose, "x y yaw in map [m, m, rad]")->expected(3);
  goto_command->add_option("--max-speed", arguments->max_speed, "Pace [m/s]; 0 = default");
  goto_command->add_flag("--no-wait", arguments->no_wait, "Return when the goal is taken");
  goto_command->callback([=, &exit_code] { exit_code = go(meant_domain(*domain), *arguments); });

  auto emergency = std::make_shared<bool>(false);
  auto* stop_command = with_domain(
      app.add_subcommand("stop", "Stop the robot; it stays stopped until `usher move`"));
  stop_command->add_flag("--emergency", *emergency,
                         "Motors off: a Segway drops on its tilt limiters");
  stop_command->callback([=, &exit_code] {
    exit_code =
        ask_supervisor(meant_domain(*domain), *emergency ? COMMAND_EMERGENCY_STOP : COMMAND_STOP,
                       *emergency ? "emergency stop" : "stopped");
  });
  with_domain(app.add_subcommand("move", "Lift `usher stop`; a latched fault needs `usher clear`"))
      ->callback([=, &exit_code] {
        exit_code =
            ask_supervisor(meant_domain(*domain), COMMAND_MOVEMENT_ON, "the stop is lifted");
      });
  with_domain(app.add_subcommand(
                  "clear", "Clear latched faults (an emergency stop is one) whose cause is gone"))
      ->callback([=, &exit_code] {
        exit_code = ask_supervisor(meant_domain(*domain), COMMAND_CLEAR, "cleared");
      });

  auto path = std::make_shared<std::string>();
  auto* map_command = app.add_subcommand("map", "Work with maps");
  map_command->require_subcommand(1);
  auto* save_command =
      with_domain(map_command->add_subcommand("save", "Write the running robot's map to a file"));
  save_command->add_option("file", *path, "YAML file; the picture is written beside it")
      ->required();
  save_command->callback([=, &exit_code] { exit_code = save_map(meant_domain(*domain), *path); });

  auto from_log = std::make_shared<MapFromLogArguments>();
  auto* log_command = map_command->add_subcommand(
      "from-log", "Make a map from a recorded log whose scans have reference poses");
  log_command->add_option("log", from_log->log, "CARMEN log (.clf, also .gz)")->required();
  log_command
      ->add_option("--reference", from_log->reference,
                   "Pose of each scan, one line `index time x y yaw` (.txt, also .gz)")
      ->required();
  log_command->add_option("--out", from_log->out, "YAML file; the picture is written beside it")
      ->required();
  log_command->add_option("--every", from_log->every, "Use every Nth scan")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  log_command->add_option("--resolution", from_log->resolution, "Side of a cell [m]")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  log_command->callback([=, &exit_code] { exit_code = map_from_log(*from_log); });
}

}  // namespace usher::operations
