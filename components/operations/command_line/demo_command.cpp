#include <signal.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/host/machine_load.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/results/result_sheet.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;

constexpr auto kLongestRun = std::chrono::minutes(6);
constexpr double kArrivalTolerance = 0.4;  // [m] of the robot from the goal
constexpr double kVisitorTolerance = 3.5;  // [m] of the visitor from the robot
constexpr double kPaceTolerance = 0.5;     // [s] that the simulation may fall behind
constexpr const char* kVisitor = "visitor";

std::atomic<bool> stop_asked{false};

int fail(const std::string& message) {
  std::cerr << "usher: " << message << "\n";
  return 1;
}

/// The record of the run, fed by the middleware's threads.
struct Watch {
  std::mutex mutex;
  RunRecord record;
  std::optional<grid::OccupancyGrid> map;
  bool succeeded = false;
  MachineLoad load;
  bool granted = false;  ///< the robot has the right to drive

  template <class Message>
  void take(const Message& message) {
    const std::lock_guard lock(mutex);
    record.take(message);
    if constexpr (std::is_same_v<Message, usher_msgs::msg::NavigateStatus>) {
      succeeded =
          succeeded || message.state() == usher_msgs::msg::GoalStatus_Constants::STATE_SUCCEEDED;
    }
  }
};

void take_grant(Watch& watch, const usher_msgs::msg::SupervisorStatus& status) {
  const std::lock_guard lock(watch.mutex);
  if (watch.granted && !status.granted()) watch.load.stopped(status.reason());
  watch.granted = status.granted();
}

/// Where the dialogue is, in one line; empty when nothing is new.
std::string progress_line(Watch& watch, std::string& last_state) {
  const std::lock_guard lock(watch.mutex);
  const auto& screen = watch.record.screen();
  if (!screen) return {};
  const bool driving = screen->state() == "guide_active";
  if (screen->state() == last_state && !driving) return {};
  last_state = screen->state();
  std::string line = "  " + screen->title();
  if (driving) {
    const auto& status = watch.record.navigation();
    const auto& samples = watch.record.samples();
    line = "  driving";
    if (status) {
      line += format("  %3.0f %%", status->progress() * 100.0) +
              format("  %5.1f m left", status->remaining());
      if (std::isfinite(status->eta())) line += format("  %3.0f s", status->eta());
      if (!status->reason().empty()) line += "  " + status->reason();
    }
    if (!samples.empty())
      line += format("  %4.2f m/s", samples.back().v) +
              format("  clearance %.2f m", samples.back().clearance);
  }
  return line;
}

bool over(Watch& watch) {
  const std::lock_guard lock(watch.mutex);
  const auto& dialogue = watch.record.dialogue();
  return !dialogue.empty() && (dialogue.back() == "guide_error" || dialogue.back() == "end");
}

ResultSheet judge(Watch& watch, const std::string& input) {
  const std::lock_guard lock(watch.mutex);
  const auto summary = watch.record.summary();
  ResultSheet sheet;
  sheet.name = "demo";
  sheet.input = input;
  const auto truth = watch.record.truth();
  const auto& navigation = watch.record.navigation();
  const auto visitor = watch.record.person(kVisitor);
  double off_goal = std::numeric_limits<double>::infinity();
  double visitor_off = std::numeric_limits<double>::infinity();
  if (truth && navigation) {
    const auto& goal = navigation->goal().pose().position();
    off_goal = std::hypot(truth->x - goal.x(), truth->y - goal.y());
  }
  if (truth && visitor) visitor_off = (truth->position() - *visitor).norm();
  sheet.flags["reached"] =
      watch.succeeded && off_goal < kArrivalTolerance && visitor_off < kVisitorTolerance;
  sheet.flags["kept_pace"] = summary.worst_lag < kPaceTolerance;
  sheet.metrics = {{"time_s", summary.seconds},
                   {"path_m", summary.path},
                   {"mean_speed_m_s", summary.mean_speed},
                   {"smallest_clearance_m", summary.smallest_clearance},
                   {"localization_error_mean_m", summary.localization_mean},
                   {"localization_error_max_m", summary.localization_max},
                   {"off_goal_m", off_goal},
                   {"visitor_distance_m", visitor_off},
                   {"contacts", summary.contacts},
                   {"touches", summary.touches},
                   {"worst_lag_s", summary.worst_lag},
                   {"machine_tasks_per_core", watch.load.per_core()},
                   {"grants_lost", watch.load.stops()}};
  sheet.published = {{"localization_error_mean_m", 0.019}, {"mean_speed_m_s", 0.72}};
  sheet.targets = {{"contacts", {Bound::kAtMost, 0.0}}};
  return sheet;
}

struct DemoArguments {
  std::string out = "build/demo";
  std::string destination;
  std::uint64_t seed = 1;
};

int demo(const DemoArguments& arguments) {
  const auto installation = Installation::of_this_program();
  const std::string manifest =
      std::filesystem::weakly_canonical(installation.share + "/deploy/demo.yaml").string();
  std::vector<Override> overrides;
  if (!arguments.destination.empty())
    overrides.push_back({kVisitor, "destination", arguments.destination});
  overrides.push_back({"tablet", "pictures",
                       std::filesystem::absolute(arguments.out + "/screens").lexically_normal()});
  // What an earlier run left would pass for this one's.
  std::error_code ignored;
  std::filesystem::remove_all(arguments.out + "/screens", ignored);
  std::filesystem::remove(arguments.out + "/result.json", ignored);
  auto deployment = load_deployment(manifest, installation, overrides);
  if (!deployment) return fail(deployment.error());
  for (auto& file : deployment->files) file.seed = arguments.seed;
  for (const auto& finding : deployment->findings) {
    std::cerr << to_string(finding) << "\n";
  }
  auto launcher = Launcher::create(
      *deployment,
      {"", installation.programs, default_run_directory(deployment->manifest.domain, "")});
  if (!launcher) return fail(launcher.error());
  std::error_code error;
  std::filesystem::create_directories(arguments.out, error);

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  Watch watch;
  auto observer =
      Observer::create({.name = "judge", .host = "nuc", .domain = deployment->manifest.domain});
  if (!observer) return fail(observer.error());
  const auto take = [&](const auto& message, const auto&) { watch.take(message); };
  const auto truth = (*observer)->reader(topics::kSimGroundTruth, take);
  const auto pose = (*observer)->reader(topics::kAmclPose, take);
  const auto plan = (*observer)->reader(topics::kPlan, take);
  const auto status = (*observer)->reader(topics::kNavigateStatus, take);
  const auto screen = (*observer)->reader(topics::kDialogueScreen, take);
  const auto wanted = (*observer)->reader(topics::kCmdVelNavigation, take);
  const auto command = (*observer)->reader(topics::kDriveCommand, take);
  const auto whiskers = (*observer)->reader(topics::kWhiskers, take);
  const auto supervisor =
      (*observer)->reader(topics::kSupervisorStatus,
                          [&](const auto& message, const auto&) { take_grant(watch, message); });
  auto map = (*observer)->reader(topics::kMap, [&](const auto& message, const auto&) {
    if (auto grid = wire::from_message(message)) {
      const std::lock_guard lock(watch.mutex);
      watch.map = std::move(grid).value();
    }
  });

  std::cout << "MARVIN guides a visitor through the office: "
            << deployment->manifest.components.size() << " components as processes, DDS domain "
            << deployment->manifest.domain << "\n"
            << std::flush;
  const auto start = std::chrono::steady_clock::now();
  auto next_line = start;
  std::string state;
  while (!stop_asked && !launcher->incomplete() && !over(watch) &&
         std::chrono::steady_clock::now() - start < kLongestRun) {
    launcher->poll();
    for (const auto& event : launcher->events()) {
      if (!event.ends_with(": started")) std::cout << "  " << event << "\n";
    }
    if (std::chrono::steady_clock::now() >= next_line) {
      next_line += milliseconds(1000);
      {
        const std::lock_guard lock(watch.mutex);
        watch.load.sample();
      }
      const auto line = progress_line(watch, state);
      if (!line.empty()) std::cout << line << "\n";
    }
    std::cout << std::flush;
    std::this_thread::sleep_for(milliseconds(20));
  }
  const bool broken = launcher->incomplete();
  launcher->stop();
  if (stop_asked) return fail("stopped before the end");
  if (broken) {
    const std::lock_guard lock(watch.mutex);
    const std::string load = watch.load.verdict();
    return fail("a component cannot be kept running; its log is in " + launcher->run_directory() +
                (load.empty() ? "" : "\nusher: " + load));
  }

  const ResultSheet sheet =
      judge(watch, "deploy/demo.yaml, seed " + std::to_string(arguments.seed));
  const std::lock_guard lock(watch.mutex);
  Status saved = write_file(arguments.out + "/result.json", sheet.json());
  if (saved) saved = write_file(arguments.out + "/table.md", sheet.markdown());
  if (saved) saved = write_file(arguments.out + "/run.csv", run_csv(watch.record));
  if (saved && watch.map)
    saved =
        draw_run(watch.record, *watch.map, "MARVIN guides a visitor", arguments.out + "/run.png");
  std::cout << "\n" << sheet.markdown() << "\n";
  if (!saved) return fail(saved.error());
  std::cout << (sheet.pass() ? "the visitor got there"
                             : "the visitor did not get there as promised")
            << "; picture, table, result.json and the tablet's screens are in " << arguments.out
            << "\n";
  if (!sheet.pass() && watch.load.too_busy()) return fail(watch.load.verdict());
  return sheet.pass() ? 0 : 1;
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DemoArguments>();
  auto* command =
      app.add_subcommand("demo", "Launch MARVIN in simulation, guide a visitor, judge the run");
  command->add_option("--out", arguments->out, "Folder for picture, table and result.json")
      ->capture_default_str();
  command->add_option("--to", arguments->destination, "Location that the visitor asks for");
  command->add_option("--seed", arguments->seed, "Of the simulation")->capture_default_str();
  command->callback([arguments, &exit_code] { exit_code = demo(*arguments); });
}

}  // namespace usher::operations
