#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "operations/command_line/background_output.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/demo.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/experiments/site_facts.hpp"
#include "operations/host/machine_load.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/launcher/run_places.hpp"
#include "operations/results/result_sheet.hpp"
#include "runtime/dds/observer.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;

constexpr const char* kGuide = "guide";
constexpr const char* kMeeting = "meeting";
constexpr double kPaceTolerance = 0.5;  // [s] that the simulation may fall behind

std::atomic<bool> stop_asked{false};

/// The record of the run, fed by the middleware's threads.
struct Watch {
  std::mutex mutex;
  RunRecord record;
  std::optional<grid::OccupancyGrid> map;
  MachineLoad load;
  bool granted = false;  ///< the robot has the right to drive
  bool over = false;     ///< what follows is the launcher ending its processes

  template <class Message>
  void take(const Message& message) {
    const std::lock_guard lock(mutex);
    if (!over) record.take(message);
  }
};

void take_grant(Watch& watch, const usher_msgs::msg::SupervisorStatus& status) {
  const std::lock_guard lock(watch.mutex);
  if (watch.over) return;
  if (watch.granted && !status.granted()) watch.load.stopped(status.reason());
  watch.granted = status.granted();
}

ResultSheet judge(const Demo& demo, Watch& watch, std::uint64_t seed) {
  const std::lock_guard lock(watch.mutex);
  const auto summary = watch.record.summary();
  ResultSheet sheet;
  sheet.name = demo.text().name;
  sheet.input = "deploy/" + demo.text().manifest + ", seed " + std::to_string(seed);
  sheet.flags["kept_pace"] = summary.worst_lag < kPaceTolerance;
  sheet.metrics = {{"time_s", summary.seconds},
                   {"path_m", summary.path},
                   {"mean_speed_m_s", summary.mean_speed},
                   {"smallest_clearance_m", summary.smallest_clearance},
                   {"localization_error_mean_m", summary.localization_mean},
                   {"localization_error_max_m", summary.localization_max},
                   {"contacts", summary.contacts},
                   {"touches", summary.touches},
                   {"worst_lag_s", summary.worst_lag},
                   {"machine_tasks_per_core", watch.load.per_core()},
                   {"grants_lost", watch.load.stops()}};
  sheet.published = {{"localization_error_mean_m", 0.019}};
  sheet.targets = {{"contacts", {Bound::kAtMost, 0.0}}};
  demo.judge(watch.record, sheet);
  return sheet;
}

struct DemoArguments {
  std::string what = kGuide;
  std::string out;
  std::string destination;
  std::uint64_t seed = 1;
  bool pixels = false;
};

/// Subscriptions to topics of all types. Must end before its observer.
class Subscriptions {
 public:
  explicit Subscriptions(Observer& observer) : observer_(observer) {}

  template <class Message, class Take>
  void add(const topics::Topic<Message>& topic, Take take) {
    if (!status_) return;
    auto reader =
        observer_.reader(topic, [take](const auto& message, const auto&) { take(message); });
    if (reader)
      readers_.push_back(std::make_shared<Observer::Reader<Message>>(std::move(reader).value()));
    else
      status_ = Error{reader.error()};
  }
  /// Of all that was added.
  const Status& status() const { return status_; }

 private:
  Observer& observer_;
  Status status_;
  std::vector<std::shared_ptr<void>> readers_;
};

/// Everything that the record of a run is made of.
void listen(Watch& watch, Subscriptions& subscriptions) {
  const auto record = [&watch](const auto& message) { watch.take(message); };
  subscriptions.add(topics::kSimGroundTruth, record);
  subscriptions.add(topics::kAmclPose, record);
  subscriptions.add(topics::kPlan, record);
  subscriptions.add(topics::kNavigateStatus, record);
  subscriptions.add(topics::kDialogueScreen, record);
  subscriptions.add(topics::kCmdVelNavigation, record);
  subscriptions.add(topics::kDriveCommand, record);
  subscriptions.add(topics::kWhiskers, record);
  subscriptions.add(topics::kSupervisorStatus,
                    [&watch](const auto& message) { take_grant(watch, message); });
  subscriptions.add(topics::kMap, [&watch](const auto& message) {
    if (auto grid = wire::from_message(message)) {
      const std::lock_guard lock(watch.mutex);
      watch.map = std::move(grid).value();
    }
  });
}

/// The demo's deployment; its tablet's pictures go to `out`.
Result<Deployment> deployment_for(const Demo& demo, const Installation& installation,
                                  const std::string& out, std::uint64_t seed) {
  const std::string manifest =
      std::filesystem::weakly_canonical(installation.share + "/deploy/" + demo.text().manifest)
          .string();
  std::vector<Override> overrides = demo.overrides();
  overrides.push_back(
      {"tablet", "pictures", std::filesystem::absolute(out + "/screens").lexically_normal()});
  auto deployment = load_deployment(manifest, installation, overrides);
  if (!deployment) return deployment;
  for (auto& file : deployment->files) file.seed = seed;
  for (const auto& finding : deployment->findings) std::cerr << to_string(finding) << "\n";
  return deployment;
}

/// Until the demo is over, somebody stops it or a component cannot be kept running.
void run(Demo& demo, Launcher& launcher, Watch& watch) {
  const auto start = std::chrono::steady_clock::now();
  auto next_line = start;
  BackgroundOutput output(STDOUT_FILENO);  // a paused terminal must not keep the launcher waiting
  const auto goes_on = [&] {
    const std::lock_guard lock(watch.mutex);
    demo.step();
    return !demo.over(watch.record) && std::chrono::steady_clock::now() - start < demo.longest();
  };
  while (!stop_asked && !launcher.incomplete() && goes_on()) {
    launcher.poll();
    for (const auto& event : launcher.events()) {
      if (!event.ends_with(": started")) output.say("  " + event + "\n");
    }
    if (std::chrono::steady_clock::now() >= next_line) {
      next_line += milliseconds(1000);
      const std::lock_guard lock(watch.mutex);
      watch.load.sample();
      if (const auto line = demo.progress(watch.record); !line.empty())
        output.say("  " + line + "\n");
    }
    std::this_thread::sleep_for(milliseconds(20));
  }
}

/// Writes and shows how it went; the exit code.
int conclude(const Demo& demo, Watch& watch, std::uint64_t seed, const std::string& out) {
  const ResultSheet sheet = judge(demo, watch, seed);
  const std::lock_guard lock(watch.mutex);
  Status saved = write_file(out + "/result.json", sheet.json());
  if (saved) saved = write_file(out + "/table.md", sheet.markdown());
  if (saved) saved = write_file(out + "/run.csv", run_csv(watch.record));
  if (saved && watch.map)
    saved = draw_run(watch.record, *watch.map, demo.text().title, out + "/run.png");
  std::cout << "\n" << sheet.markdown() << "\n";
  if (!saved) return fail(saved.error());
  std::cout << (sheet.pass() ? demo.text().kept : demo.text().broken)
            << "; picture, table, result.json and the tablet's screens are in " << out << "\n";
  if (!sheet.pass() && watch.load.too_busy()) return fail(watch.load.verdict());
  return sheet.pass() ? 0 : 1;
}

/// The site has a location of that name; an empty one is the demo's own.
Status knows(const Deployment& deployment, const std::string& location) {
  if (location.empty()) return {};
  const auto all = site_locations(deployment);
  if (!all) return Error{all.error()};
  if (std::ranges::find(*all, location) != all->end()) return {};
  std::string names;
  for (const std::string& name : *all) names += (names.empty() ? "" : ", ") + name;
  return Error{"--to names no location of the site: " + location + "; it has " + names};
}

int demo(const DemoArguments& arguments) {
  const bool meets = arguments.what == kMeeting;
  if (meets && !arguments.destination.empty())
    return misused("--to is the guide's: the meeting assistant looks for the room itself");
  if (meets && arguments.pixels)
    return misused("--pixels is the guide's: `usher experiment gather-pixels` renders a meeting");
  const std::string out =
      !arguments.out.empty() ? arguments.out : (meets ? "build/demo-meeting" : "build/demo");
  auto made = meets ? meeting_demo() : guide_demo(arguments.destination, arguments.pixels);
  const auto installation = Installation::of_this_program();
  // What an earlier run left would pass for this one's.
  std::error_code ignored;
  std::filesystem::remove_all(out + "/screens", ignored);
  std::filesystem::remove(out + "/result.json", ignored);
  const auto deployment = deployment_for(*made, installation, out, arguments.seed);
  if (!deployment) return fail(deployment.error());
  if (const Status known = knows(*deployment, arguments.destination); !known)
    return misused(known.error());
  const std::uint32_t domain = deployment->manifest.domain;
  auto launcher =
      Launcher::create(*deployment, {"", installation.programs, default_run_directory(domain, "")});
  if (!launcher) return fail(launcher.error());
  std::filesystem::create_directories(out, ignored);  // where it fails, so does the writing

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  Watch watch;
  auto observer = Observer::create({.name = "judge", .domain = domain});
  if (!observer) return fail(observer.error());
  const auto demo = std::move(made);  // ends before the observer
  Subscriptions subscriptions(**observer);
  listen(watch, subscriptions);
  if (!subscriptions.status()) return fail(subscriptions.status().error());
  if (const Status attached = demo->attach(*deployment, **observer, watch.mutex); !attached)
    return fail(attached.error());

  std::cout << demo->text().title << ": " << deployment->manifest.components.size()
            << " components as processes, DDS domain " << domain << "\n"
            << std::flush;
  run(*demo, *launcher, watch);
  const bool broken = launcher->incomplete();
  {
    const std::lock_guard lock(watch.mutex);
    watch.over = true;
  }
  launcher->stop();
  if (stop_asked) return fail("stopped before the end");
  if (broken) {
    const std::lock_guard lock(watch.mutex);
    const std::string load = watch.load.verdict();
    return fail("a component cannot be kept running; its log is in " + launcher->run_directory() +
                (load.empty() ? "" : "\nusher: " + load));
  }
  return conclude(*demo, watch, arguments.seed, out);
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DemoArguments>();
  auto* command = app.add_subcommand("demo",
                                     "Launch a simulated robot that does its main job, "
                                     "judge the run");
  command
      ->add_option("what", arguments->what,
                   "guide: MARVIN and a visitor; meeting: the meeting "
                   "assistant and two people")
      ->check(CLI::IsMember({kGuide, kMeeting}))
      ->capture_default_str();
  command->add_option("--out", arguments->out,
                      "Folder for picture, table and result.json; else build/demo or "
                      "build/demo-meeting");
  command->add_option("--to", arguments->destination, "Location that the visitor asks for");
  command->add_option("--seed", arguments->seed, "Of the simulation")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag(
      "--pixels", arguments->pixels,
      "The guide: render every pixel of both depth cameras for the depth pipeline and "
      "the people detector themselves, not for the models fitted to them; half of "
      "a core more");
  command->callback([arguments, &exit_code] { exit_code = demo(*arguments); });
}

}  // namespace usher::operations
