#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "idl/topics.hpp"
#include "navigation/navigator/core/locations.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/supervisor_client.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
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
constexpr auto kAside = milliseconds(500);       // for the last words of other goals
constexpr auto kGone = std::chrono::seconds(5);  // longer than the launcher needs to restart it
constexpr double kFastest = 3.0;                 // [m/s] that a robot's file may allow
constexpr const char* kClient = kOperatorName;

std::atomic<bool> stop_asked{false};

struct GoalArguments {
  std::string location;
  std::vector<double> pose;
  double max_speed = 0.0;
  bool no_wait = false;
  bool cancel = false;
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

/// What no robot can be asked for.
Status judge(const GoalArguments& arguments) {
  if (!std::ranges::all_of(arguments.pose, [](double value) { return std::isfinite(value); }))
    return Error{"--pose must be finite"};
  if (!arguments.location.empty() && !arguments.pose.empty())
    return Error{"give a location or --pose, not both"};
  const bool alone = arguments.location.empty() && arguments.pose.empty() && !arguments.no_wait &&
                     arguments.max_speed == 0.0;
  if (arguments.cancel && !alone)
    return Error{"--cancel gives up the goal that is under way; it stands alone"};
  return {};
}

/// What the navigator would refuse, before anybody is asked for anything: what runs goes on.
Status judge_location(const GoalArguments& arguments, const navigator::Locations& locations) {
  if (arguments.location.empty()) return {};
  const auto found = locations.find(arguments.location);
  if (found) return {};
  std::string names;
  for (const auto& location : locations.all()) names += (names.empty() ? "" : " ") + location.name;
  return Error{found.error() + "\nlocations: " + names};
}

/// Whether the running robot can go that fast. Where nothing tells its limit, that holds as it is.
Status ask_pace(Observer& observer, double pace) {
  if (pace == 0.0) return {};
  auto reader = observer.reader(topics::kMovementStatus);
  if (!reader) return Error{reader.error()};
  const auto status = reader->take(kPatience);
  return status ? judge_pace(pace, status->velocity_linear_max_normal()) : Status{};
}

/// How the robot drives: on a terminal one line that is rewritten, else a line now and then.
class ProgressLine {
 public:
  void show(const NavigateStatus& status) {
    const auto now = std::chrono::steady_clock::now();
    if (!terminal_ && now - shown_ < kEvery) return;
    shown_ = now;
    const bool known = std::isfinite(status.eta());  // there is a plan
    std::cout << (terminal_ ? "\r" : "") << format("%3.0f %%", status.progress() * 100.0) << "  "
              << (known ? format("%5.1f m left", status.remaining()) +
                              format("  %4.0f s", status.eta())
                        : "    - m left     -")
              << (status.reason().empty() ? "" : "  " + status.reason())
              << (terminal_ ? "\033[K" : "\n") << std::flush;
  }
  /// What follows begins a line of its own.
  void end() const {
    if (terminal_ && shown_ != std::chrono::steady_clock::time_point{}) std::cout << "\n";
    std::cout << std::flush;
  }

 private:
  static constexpr auto kEvery = std::chrono::seconds(5);
  bool terminal_ = isatty(STDOUT_FILENO) != 0;
  std::chrono::steady_clock::time_point shown_{};
};

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
  explicit SupervisorWatch(Observer::Reader<SupervisorStatus> reader)
      : reader_(std::move(reader)) {}

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
  Observer::Reader<SupervisorStatus> reader_;
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

/// A stop that somebody holds lets nothing drive, whatever the navigation may do.
void warn_of_stop(Observer& observer) {
  auto reader = observer.reader(topics::kSupervisorStatus);
  const auto status = reader ? newest_status(*reader, kPatience) : nullptr;
  if (!status || status->stopped_by().empty()) return;
  std::cerr << "usher: the robot stands, stopped by " << stopped_by(*status)
            << "; `usher move` lifts that\n";
}

bool is_under_way(const NavigateStatus& status) {
  return status.state() == GoalStatus_Constants::STATE_ACTIVE ||
         status.state() == GoalStatus_Constants::STATE_WAITING;
}

/// Repeats the cancellation until `answers` says of the navigator's status that it has answered.
Status cancel_goal(Observer& observer, Observer::Reader<NavigateStatus>& statuses, std::uint64_t id,
                   const std::function<bool(const NavigateStatus&)>& answers) {
  auto writer = observer.writer(topics::kNavigateCancel);
  if (!writer) return Error{writer.error()};
  GoalCancel message;
  message.id(id);
  message.client(kClient);
  for (int tries = 0; tries < 15; ++tries) {
    writer->write(message);
    const auto until = std::chrono::steady_clock::now() + kRepeat;
    while (std::chrono::steady_clock::now() < until) {
      const auto status = statuses.take(milliseconds(50));
      if (status && answers(*status)) return {};
    }
  }
  return Error{"the navigator did not cancel the goal within 3 s"};
}

/// The goal that is under way: the last words of others stand beside it for a moment.
Result<NavigateStatus> goal_under_way(Observer::Reader<NavigateStatus>& statuses,
                                      std::uint32_t domain) {
  auto status = statuses.take(kPatience);
  if (!status) return Error{nobody_there("navigator", domain)};
  const auto until = std::chrono::steady_clock::now() + kAside;
  while (!is_under_way(*status) && std::chrono::steady_clock::now() < until) {
    if (const auto newer = statuses.take(milliseconds(50))) status = newer;
  }
  if (!is_under_way(*status)) return Error{"no goal is under way"};
  return *status;
}

/// Gives up an operator's goal, whichever terminal it came from. Its end is the navigation's, too.
int cancel_operators(Observer& observer, std::uint32_t domain) {
  auto statuses = observer.reader(topics::kNavigateStatus);
  if (!statuses) return fail(statuses.error());
  const auto goal = goal_under_way(*statuses, domain);
  if (!goal) return fail(goal.error());
  if (goal->client() == "guide" || goal->client() == "meeting")
    return fail("the goal under way is the " + goal->client() + "'s, which sees to it: " +
                (goal->client() == "guide" ? "`usher stop` stops the robot"
                                           : "`usher meet --cancel` ends the meeting"));
  bool replaced = false;
  const auto given_up = cancel_goal(observer, *statuses, goal->id(), [&](const auto& status) {
    replaced = status.id() != goal->id() && is_under_way(status);
    return replaced || (status.id() == goal->id() && !is_under_way(status));
  });
  if (!given_up) return fail(given_up.error());
  if (replaced) return fail("another goal took its place");
  std::cout << "the goal " << (goal->location().empty() ? "pose" : goal->location())
            << " is given up\n";
  return 0;
}

enum class Outcome { kUnderWay, kArrived, kFailed, kReplaced };

/// Sends a goal and watches it to its end; Ctrl-C cancels it.
class Pursuit {
 public:
  static Result<Pursuit> begin(Observer& observer, std::uint32_t domain,
                               const GoalArguments& arguments) {
    auto goals = observer.writer(topics::kNavigateGoal);
    auto statuses = observer.reader(topics::kNavigateStatus);
    auto supervisor = observer.reader(topics::kSupervisorStatus);
    if (!goals) return Error{goals.error()};
    if (!supervisor) return Error{supervisor.error()};
    if (!statuses) return Error{statuses.error()};
    if (!goals->wait_for_readers(1, kPatience)) return Error{nobody_there("navigator", domain)};
    return Pursuit(observer, arguments, std::move(goals).value(), std::move(statuses).value(),
                   std::move(supervisor).value());
  }

  Outcome run() {
    given_ = heard_ = Clock::now();
    for (;;) {
      if (stop_asked) {
        const auto cancelled = cancel();
        return failed(cancelled ? "cancelled" : cancelled.error());
      }
      if (!accepted_ && Clock::now() - given_ > kPatience)
        return failed("the navigator did not take the goal within 3 s");
      if (!accepted_ && Clock::now() - told_ > kRepeat) {
        goals_.write(goal_);
        told_ = Clock::now();
      }
      const auto status = statuses_.take(milliseconds(100));
      if (status) heard_ = Clock::now();
      if (Clock::now() - heard_ > kGone)
        return failed(
            "the navigator has been silent for 5 s; what it did with the goal is not known");
      if (const auto refused = heed_supervisor(); !refused) return failed(refused.error());
      if (!status) continue;
      if (const auto outcome = take(*status)) return *outcome;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  Pursuit(Observer& observer, const GoalArguments& arguments, Observer::Writer<NavigateGoal> goals,
          Observer::Reader<NavigateStatus> statuses, Observer::Reader<SupervisorStatus> supervisor)
      : observer_(observer),
        arguments_(arguments),
        goal_(goal_from(arguments)),
        goals_(std::move(goals)),
        statuses_(std::move(statuses)),
        supervisor_(std::move(supervisor)) {}

  Outcome failed(const std::string& reason) {
    progress_.end();
    fail(reason);
    return Outcome::kFailed;
  }

  /// Why it goes no further, as far as the supervisor is concerned.
  Status heed_supervisor() {
    const auto why = supervisor_.ended_navigation();
    if (!accepted_) return {};
    if (supervisor_.forgot_navigation()) return start_navigation(observer_, arguments_);
    if (!why) return {};
    const auto cancelled = cancel();
    return Error{*why + (cancelled ? "" : "; " + cancelled.error())};
  }

  /// What became of the goal; nothing while it runs.
  std::optional<Outcome> take(const NavigateStatus& status) {
    const bool runs = is_under_way(status);
    if (status.id() != goal_.id()) {
      if (accepted_ && status.id() == 0) {  // restarted: it has forgotten everything
        accepted_ = false;
        given_ = Clock::now();
      }
      if (!accepted_ || !runs) return std::nullopt;
      failed("another goal took its place");
      return Outcome::kReplaced;
    }
    accepted_ = true;
    if (arguments_.no_wait && runs) {
      std::cout << "the goal is taken; `usher status` shows how far it is\n";
      return Outcome::kUnderWay;
    }
    progress_.show(status);
    if (runs) return std::nullopt;
    if (status.state() == GoalStatus_Constants::STATE_SUCCEEDED) {
      progress_.end();
      std::cout << "arrived\n";
      return Outcome::kArrived;
    }
    const Outcome outcome = failed(status.reason());
    return status.state() == GoalStatus_Constants::STATE_REPLACED ? Outcome::kReplaced : outcome;
  }

  /// Once the navigator took the goal, a status of another one is an answer too.
  Status cancel() {
    return cancel_goal(observer_, statuses_, goal_.id(), [this](const auto& status) {
      return status.id() == goal_.id() ? status.state() >= GoalStatus_Constants::STATE_SUCCEEDED
                                       : accepted_;
    });
  }

  Observer& observer_;
  const GoalArguments& arguments_;
  NavigateGoal goal_;
  Observer::Writer<NavigateGoal> goals_;
  Observer::Reader<NavigateStatus> statuses_;
  SupervisorWatch supervisor_;
  ProgressLine progress_;
  Clock::time_point told_{}, heard_{}, given_{};
  bool accepted_ = false;
};

/// The supervisor lets the navigation drive from the start to the end of a goal.
int go(std::uint32_t domain, const GoalArguments& arguments) {
  using namespace SupervisorRequest_Constants;
  auto observer = Observer::create(reach_robot(kClient, domain));
  if (!observer) return fail(observer.error());
  if (arguments.cancel) return cancel_operators(**observer, domain);
  if (const auto possible = ask_pace(**observer, arguments.max_speed); !possible)
    return fail(possible.error());
  const auto locations = locations_of(**observer, domain);
  if (!locations) return fail(locations.error());
  if (arguments.location.empty() && arguments.pose.empty()) return list(*locations);
  if (const auto known = judge_location(arguments, *locations); !known) return fail(known.error());
  if (!arguments.pose.empty()) {
    if (const auto inside = judge_place(**observer, arguments.pose[0], arguments.pose[1]); !inside)
      return fail("--pose " + inside.error());
  }
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  if (const auto told = start_navigation(**observer, arguments); !told) return fail(told.error());
  warn_of_stop(**observer);
  Outcome outcome = Outcome::kFailed;
  if (auto pursuit = Pursuit::begin(**observer, domain, arguments)) {
    outcome = pursuit->run();
  } else {
    fail(pursuit.error());
  }
  if (outcome == Outcome::kFailed) {  // one that was replaced leaves the navigation to the other
    if (const auto told = tell_supervisor(**observer, COMMAND_NAVIGATION_END); !told) {
      std::cerr << "usher: the navigation could not be ended: " << told.error() << "\n";
    }
  }
  return outcome == Outcome::kUnderWay || outcome == Outcome::kArrived ? 0 : 1;
}

}  // namespace

void add_goto_command(CLI::App& app, int& exit_code) {
  auto domain = std::make_shared<std::optional<std::uint32_t>>();
  auto arguments = std::make_shared<GoalArguments>();
  auto* goto_command = app.add_subcommand(
      "goto", "Send the robot to a location or a pose; without either, list the locations");
  add_domain_option(*goto_command, *domain);
  goto_command->add_option("location", arguments->location, "Name of a known location");
  goto_command->add_option("--pose", arguments->pose, "x y yaw in map [m, m, rad]")->expected(3);
  goto_command->add_option("--max-speed", arguments->max_speed, "Pace [m/s]; 0 = default")
      ->check(within(0, kFastest));
  goto_command->add_flag("--no-wait", arguments->no_wait, "Return when the goal is taken");
  goto_command->add_flag("--cancel", arguments->cancel, "Give up the goal that is under way");
  goto_command->callback([=, &exit_code] {
    const auto sound = judge(*arguments);
    exit_code = sound ? go(meant_domain(*domain), *arguments) : misused(sound.error());
  });
}

}  // namespace usher::operations
