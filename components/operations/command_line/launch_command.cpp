#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <ctime>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "idl/topics.hpp"
#include "operations/command_line/background_output.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/host/service.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/launcher/run_places.hpp"
#include "operations/security/permissions.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;

std::atomic<bool> stop_asked{false};

/// The newest heartbeat of every component of the manifest, and when the supervisor last heard it.
/// Other names are nobody's: whoever writes ever new ones fills no memory.
class Heartbeats {
 public:
  struct Entry {
    usher_msgs::msg::Heartbeat message;
    std::optional<std::chrono::steady_clock::time_point> at, by_supervisor_at;
  };

  explicit Heartbeats(const Manifest& manifest) {
    for (const auto& component : manifest.components) newest_[component.name];
  }
  void take(const usher_msgs::msg::Heartbeat& message) {
    const std::lock_guard lock(mutex_);
    const auto entry = newest_.find(message.component_name());
    if (entry == newest_.end()) return;
    entry->second.message = message;
    entry->second.at = std::chrono::steady_clock::now();
  }
  void take(const usher_msgs::msg::SupervisorStatus& message) {
    using usher_msgs::msg::SupervisorStatus_Constants::HEALTH_MISSING;
    const auto now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    for (const auto& component : message.components()) {
      const auto entry = newest_.find(component.name());
      if (entry != newest_.end() && component.health() != HEALTH_MISSING)
        entry->second.by_supervisor_at = now;
    }
  }
  void report_to(Launcher& launcher) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [component, entry] : newest_) {
      if (entry.at) launcher.heard(component, *entry.at);
      if (entry.by_supervisor_at) launcher.heard_by_supervisor(component, *entry.by_supervisor_at);
    }
  }
  std::map<std::string, Entry> entries() const {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Entry> newest_;
};

/// Whether the base was last heard to stand.
class Standing {
 public:
  void take(const usher_msgs::msg::BaseStatus& message) {
    constexpr double kSlow = 0.02;  // [m/s], [rad/s]; a balancing base never stands quite still
    const bool powered = message.state() == usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING;
    const std::lock_guard lock(mutex_);
    stands_ = !powered || (std::abs(message.v()) < kSlow && std::abs(message.w()) < kSlow &&
                           message.v_commanded() == 0.0 && message.w_commanded() == 0.0);
    at_ = std::chrono::steady_clock::now();
  }
  /// A base that is not heard any more has nobody to wait for: its guard stops it.
  bool stands() const {
    const std::lock_guard lock(mutex_);
    return stands_ || std::chrono::steady_clock::now() - at_ > milliseconds(300);
  }

 private:
  mutable std::mutex mutex_;
  bool stands_ = true;
  std::chrono::steady_clock::time_point at_{};
};

std::string state_of(const Process& process, const Heartbeats::Entry& heartbeat) {
  switch (process.state) {
    case Process::State::kWaiting:
      return "waiting";
    case Process::State::kStopping:
      return "stopping";
    case Process::State::kStopped:
      return "stopped";
    case Process::State::kGaveUp:
      return "given up";
    case Process::State::kRunning:
      break;
  }
  if (!heartbeat.at) return "starting";
  if (std::chrono::steady_clock::now() - *heartbeat.at > milliseconds(500)) return "silent";
  constexpr const char* kStates[] = {"starting", "ok", "degraded", "fault"};
  return kStates[std::min<std::uint8_t>(heartbeat.message.state(), 3)];
}

Table live_table(const Launcher& launcher, const Heartbeats& heartbeats) {
  const auto entries = heartbeats.entries();
  Table table({"component", "state", "starts", "cpu %", "MB", "handler ms", "lost", "why"});
  for (const auto& process : launcher.processes()) {
    for (const auto& component : process.components) {
      const auto entry = entries.find(component);
      const auto heartbeat = entry == entries.end() ? Heartbeats::Entry{} : entry->second;
      const auto& message = heartbeat.message;
      const bool running = heartbeat.at && process.state == Process::State::kRunning;
      table.add({component, state_of(process, heartbeat), std::to_string(process.starts),
                 running ? format("%.1f", message.cpu_percent()) : "-",
                 running ? format("%.0f", static_cast<double>(message.memory_bytes()) / 1e6) : "-",
                 running ? format("%.1f", message.handler_time_max() * 1e3) : "-",
                 running ? std::to_string(message.samples_lost()) : "-",
                 running ? message.reason() : process.last_end});
    }
  }
  return table;
}

/// Says once who was kept out, and once in a while how many messages were dropped.
class RefusalReport {
 public:
  std::vector<std::string> news(const std::vector<runtime::Refusal>& refusals) {
    std::vector<std::string> lines;
    const auto now = std::chrono::steady_clock::now();
    for (const auto& refusal : refusals) {
      auto [entry, is_new] = told_.try_emplace({refusal.name, refusal.address});
      auto& [messages, at] = entry->second;
      if (!is_new && (refusal.messages == messages || now - at < kPause)) continue;
      lines.push_back(runtime::to_string(refusal));
      messages = refusal.messages;
      at = now;
    }
    return lines;
  }

 private:
  static constexpr std::chrono::seconds kPause{10};
  std::map<std::pair<std::string, std::string>,
           std::pair<std::uint64_t, std::chrono::steady_clock::time_point>>
      told_;
};

/// What the launcher hears of the running robot.
class RunningRobot {
 public:
  static Result<std::unique_ptr<RunningRobot>> listen(const Manifest& manifest) {
    auto reach = reach_robot(kLauncher, manifest.domain);
    if (!manifest.keys.empty()) reach.identity = manifest.keys + "/" + kLauncher;
    auto observer = runtime::Observer::create(reach);
    if (!observer) return Error{observer.error()};
    std::unique_ptr<RunningRobot> robot(new RunningRobot(manifest, std::move(observer).value()));
    if (auto status = robot->subscribe(); !status) return Error{status.error()};
    return robot;
  }

  /// Who lives.
  void report_to(Launcher& launcher) const { heartbeats_.report_to(launcher); }
  const Heartbeats& heartbeats() const { return heartbeats_; }
  bool stands() const { return standing_.stands(); }
  /// Who was kept out since the last call, in words.
  std::vector<std::string> refusals() { return refusals_.news(observer_->refusals()); }

 private:
  RunningRobot(const Manifest& manifest, std::unique_ptr<runtime::Observer> observer)
      : heartbeats_(manifest), observer_(std::move(observer)) {}
  Status subscribe() {
    auto heartbeats =
        observer_->reader(topics::kHeartbeat,
                          [this](const auto& message, const auto&) { heartbeats_.take(message); });
    if (!heartbeats) return Error{heartbeats.error()};
    auto supervisor =
        observer_->reader(topics::kSupervisorStatus,
                          [this](const auto& message, const auto&) { heartbeats_.take(message); });
    if (!supervisor) return Error{supervisor.error()};
    auto base = observer_->reader(
        topics::kBaseStatus, [this](const auto& message, const auto&) { standing_.take(message); });
    if (!base) return Error{base.error()};
    heartbeat_reader_.emplace(std::move(heartbeats).value());
    supervisor_reader_.emplace(std::move(supervisor).value());
    base_reader_.emplace(std::move(base).value());
    return {};
  }

  Heartbeats heartbeats_;
  Standing standing_;
  RefusalReport refusals_;
  std::unique_ptr<runtime::Observer> observer_;
  // Last: they end before what they fill.
  std::optional<runtime::Observer::Reader<usher_msgs::msg::Heartbeat>> heartbeat_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::SupervisorStatus>> supervisor_reader_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::BaseStatus>> base_reader_;
};

/// "14:05:09  navigator: ended with code 3", in local time.
std::string at_this_time(const std::string& event) {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%H:%M:%S  ", &local);
  return text.data() + event;
}

/// What the operator reads while it runs: events, and on a terminal a table that is rewritten once
/// a second. Nothing here waits for the terminal, or the program that should read.
class Display {
 public:
  void say(const std::string& text) {
    table_lines_ = 0;
    output_.say(text);
  }
  void show(const std::vector<std::string>& events) {
    std::string text;
    for (const auto& event : events) text += at_this_time(event) + "\n";
    if (!text.empty()) say(text);
  }
  void show_table(const Launcher& launcher, const Heartbeats& heartbeats) {
    // One that waits would be old when it is read.
    if (!terminal_ || std::chrono::steady_clock::now() < next_table_ || !output_.idle()) return;
    next_table_ = std::chrono::steady_clock::now() + milliseconds(1000);
    const Table table = live_table(launcher, heartbeats);
    std::string text;
    if (table_lines_ > 0) text = "\033[" + std::to_string(table_lines_) + "A\033[J";
    output_.say(text + table.text());
    table_lines_ = table.size() + 1;
  }

 private:
  const bool terminal_ = isatty(STDOUT_FILENO) != 0;
  BackgroundOutput output_{STDOUT_FILENO};
  std::chrono::steady_clock::time_point next_table_ =
      std::chrono::steady_clock::now() + milliseconds(1000);
  std::size_t table_lines_ = 0;
};

struct LaunchArguments {
  std::string manifest, host, run_directory;
  std::vector<Override> overrides;
};

/// The deployment as it is asked for. What is wrong with it goes to stderr.
Result<Deployment> deployment_for(const LaunchArguments& arguments,
                                  const Installation& installation) {
  auto deployment =
      load_deployment(arguments.manifest, installation, arguments.overrides, keys_folder());
  if (!deployment) return Error{deployment.error()};
  for (const auto& finding : deployment->findings) std::cerr << to_string(finding) << "\n";
  if (!deployment->findings.empty())
    return Error{"this deployment could not work; nothing was started"};
  return deployment;
}

int launch(const LaunchArguments& arguments) {
  const auto installation = Installation::of_this_program();
  const auto deployment = deployment_for(arguments, installation);
  if (!deployment) return fail(deployment.error());
  const Manifest& manifest = deployment->manifest;
  LaunchOptions options{arguments.host, installation.programs, arguments.run_directory};
  if (options.run_directory.empty())
    options.run_directory = default_run_directory(manifest.domain, arguments.host);
  ServiceNotifier service;
  auto launcher = Launcher::create(*deployment, options);
  if (!launcher) return fail(launcher.error());

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  const auto listening = RunningRobot::listen(manifest);
  if (!listening) return fail(listening.error());
  RunningRobot& robot = **listening;
  Display display;
  display.say("launching " + manifest.name + "; logs in " + options.run_directory +
              "; Ctrl-C stops the robot, then everything\n");
  service.ready();
  while (!stop_asked && !launcher->broken()) {
    robot.report_to(*launcher);
    launcher->poll();
    service.alive(launcher->healthy(), launcher->summary());
    auto events = launcher->events();
    for (auto& news : robot.refusals()) events.push_back(std::move(news));
    display.show(events);
    display.show_table(*launcher, robot.heartbeats());
    std::this_thread::sleep_for(milliseconds(20));
  }
  const bool broken = launcher->broken();
  service.stopping();
  display.say(
      std::string(broken ? "a component cannot be kept running; " : "") +
      "stopping: first the robot, then everything in reverse order, the base driver last\n");
  launcher->stop([&] { return robot.stands(); });
  display.show(launcher->events());
  return broken ? 1 : 0;
}

}  // namespace

void add_launch_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<LaunchArguments>();
  auto* launch_command = app.add_subcommand(
      "launch", "Start a deployment, watch it, restart what ends, stop it on Ctrl-C");
  launch_command->add_option("manifest", arguments->manifest, "Manifest file")->required();
  launch_command->add_option("--host", arguments->host, "Start only this host's part");
  add_set_option(*launch_command, arguments->overrides);
  launch_command->add_option("--run-directory", arguments->run_directory,
                             "Parameter files, logs, memory of the components");
  launch_command->callback([arguments, &exit_code] { exit_code = launch(*arguments); });
}

}  // namespace usher::operations
