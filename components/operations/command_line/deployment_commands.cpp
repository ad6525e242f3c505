#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/robot.hpp"
#include "operations/command_line/table.hpp"
#include "operations/host/service.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/security/permissions.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;

std::atomic<bool> stop_asked{false};

int fail(const std::string& message) {
  std::cerr << "usher: " << message << "\n";
  return 1;
}

int check(const std::vector<std::string>& manifests) {
  const auto installation = Installation::of_this_program();
  int bad = 0;
  for (const auto& path : manifests) {
    const auto deployment = load_deployment(path, installation, {}, keys_folder());
    if (!deployment) {
      ++bad;
      std::cout << path << ": unreadable: " << deployment.error() << "\n";
      continue;
    }
    for (const auto& finding : deployment->findings) {
      std::cout << to_string(finding) << "\n";
    }
    if (!deployment->findings.empty()) ++bad;
    if (deployment->findings.empty()) {
      const auto hosts = deployment->manifest.hosts.size();
      std::cout << path << ": good, " << deployment->manifest.components.size() << " components on "
                << hosts << (hosts == 1 ? " host\n" : " hosts\n");
    }
  }
  return bad == 0 ? 0 : 1;
}

/// The types that a manifest needs, for building no more than those.
int components(const std::string& path) {
  const auto manifest =
      read_manifest(path, config_directories(path, Installation::of_this_program()));
  if (!manifest) return fail(manifest.error());
  std::set<std::string> types;
  for (const auto& component : manifest->components) {
    types.insert(component.type);
    if (!component.group.empty()) types.insert("group");
  }
  for (const auto& type : types) std::cout << type << "\n";
  return 0;
}

/// The data flow in the language of graphviz: components as boxes in their hosts, topics as edges,
/// those of a fleet dashed: they come from the other robots too.
int graph(const std::string& path) {
  const auto installation = Installation::of_this_program();
  const auto contracts = read_contracts(installation.contracts);
  const auto manifest = read_manifest(path, config_directories(path, installation));
  if (!contracts) return fail(contracts.error());
  if (!manifest) return fail(manifest.error());
  std::cout << "digraph \"" << manifest->name
            << "\" {\n  rankdir=LR; node [shape=box, style=rounded];\n";
  for (std::size_t i = 0; i < manifest->hosts.size(); ++i) {
    std::cout << "  subgraph cluster_" << i << " { label=\"" << manifest->hosts[i].name << "\";";
    for (const auto& component : manifest->components) {
      if (component.host == manifest->hosts[i].name) std::cout << " \"" << component.name << "\";";
    }
    std::cout << " }\n";
  }
  std::map<std::string, std::vector<std::string>> writers;
  for (const auto& component : manifest->components) {
    const auto contract = contracts->find(component.type);
    if (contract == contracts->end()) continue;
    for (const auto& output : contract->second.outputs)
      writers[output.topic].push_back(component.name);
  }
  for (const auto& component : manifest->components) {
    const auto contract = contracts->find(component.type);
    if (contract == contracts->end()) continue;
    for (const auto& input : contract->second.inputs) {
      if (input.topic == topics::kHeartbeat.name || input.topic == topics::kTf.name ||
          input.topic == topics::kTfStatic.name)
        continue;
      for (const auto& writer : writers[input.topic]) {
        const bool of_fleet = input.scope == topics::Scope::kFleet;
        if (of_fleet && manifest->fleet.robot.empty()) continue;
        std::cout << "  \"" << writer << "\" -> \"" << component.name << "\" [label=\""
                  << input.topic << "\"" << (of_fleet ? ", style=dashed" : "") << "];\n";
      }
    }
  }
  std::cout << "}\n";
  return 0;
}

/// The newest heartbeat of every component.
class Heartbeats {
 public:
  void take(const usher_msgs::msg::Heartbeat& message) {
    const std::lock_guard lock(mutex_);
    newest_[message.component_name()] = {message, std::chrono::steady_clock::now()};
  }
  struct Entry {
    usher_msgs::msg::Heartbeat message;
    std::chrono::steady_clock::time_point at;
  };
  std::map<std::string, Entry> entries() const {
    const std::lock_guard lock(mutex_);
    return newest_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Entry> newest_;
};

/// Whom the supervisor hears.
class Roll {
 public:
  void take(const usher_msgs::msg::SupervisorStatus& message) {
    using usher_msgs::msg::SupervisorStatus_Constants::HEALTH_MISSING;
    const auto now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    for (const auto& component : message.components()) {
      if (component.health() != HEALTH_MISSING) heard_at_[component.name()] = now;
    }
  }
  void vouch(Launcher& launcher) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [component, at] : heard_at_) launcher.vouched(component, at);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::chrono::steady_clock::time_point> heard_at_;
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

std::string state_of(const Process& process, const Heartbeats::Entry* heartbeat) {
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
  if (heartbeat == nullptr) return "starting";
  if (std::chrono::steady_clock::now() - heartbeat->at > milliseconds(500)) return "silent";
  constexpr const char* kStates[] = {"starting", "ok", "degraded", "fault"};
  return kStates[std::min<std::uint8_t>(heartbeat->message.state(), 3)];
}

Table live_table(const Launcher& launcher, const Heartbeats& heartbeats) {
  const auto entries = heartbeats.entries();
  Table table({"component", "state", "starts", "cpu %", "MB", "handler ms", "lost", "why"});
  for (const auto& process : launcher.processes()) {
    for (const auto& component : process.components) {
      const auto entry = entries.find(component);
      const auto* heartbeat = entry == entries.end() ? nullptr : &entry->second;
      const bool running = heartbeat != nullptr && process.state == Process::State::kRunning;
      table.add({component, state_of(process, heartbeat), std::to_string(process.starts),
                 running ? format("%.1f", heartbeat->message.cpu_percent()) : "-",
                 running
                     ? format("%.0f", static_cast<double>(heartbeat->message.memory_bytes()) / 1e6)
                     : "-",
                 running ? format("%.1f", heartbeat->message.handler_time_max() * 1e3) : "-",
                 running ? std::to_string(heartbeat->message.samples_lost()) : "-",
                 running ? heartbeat->message.reason() : process.last_end});
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

struct LaunchArguments {
  std::string manifest, host, run_directory;
  std::vector<std::string> settings;
};

int launch(const LaunchArguments& arguments) {
  const auto installation = Installation::of_this_program();
  std::vector<Override> overrides;
  for (const auto& text : arguments.settings) {
    auto parsed = parse_override(text);
    if (!parsed) return fail(parsed.error());
    overrides.push_back(*parsed);
  }
  const auto deployment =
      load_deployment(arguments.manifest, installation, overrides, keys_folder());
  if (!deployment) return fail(deployment.error());
  for (const auto& finding : deployment->findings) {
    std::cerr << to_string(finding) << "\n";
  }
  if (!deployment->findings.empty())
    return fail("this deployment could not work; nothing was started");

  LaunchOptions options{arguments.host, installation.programs, arguments.run_directory};
  if (options.run_directory.empty())
    options.run_directory = default_run_directory(deployment->manifest.domain, arguments.host);
  ServiceNotifier service;
  auto launcher = Launcher::create(*deployment, options);
  if (!launcher) return fail(launcher.error());

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  Heartbeats heartbeats;
  auto reach = reach_robot(kLauncher, deployment->manifest.domain);
  if (!deployment->manifest.keys.empty())
    reach.identity = deployment->manifest.keys + "/" + kLauncher;
  auto observer = runtime::Observer::create(reach);
  if (!observer) return fail(observer.error());
  const auto reader = (*observer)->reader(
      topics::kHeartbeat, [&](const auto& message, const auto&) { heartbeats.take(message); });
  if (!reader) return fail(reader.error());
  Roll roll;
  const auto statuses = (*observer)->reader(
      topics::kSupervisorStatus, [&](const auto& message, const auto&) { roll.take(message); });
  if (!statuses) return fail(statuses.error());
  Standing standing;
  const auto base = (*observer)->reader(
      topics::kBaseStatus, [&](const auto& message, const auto&) { standing.take(message); });
  if (!base) return fail(base.error());

  std::cout << "launching " << deployment->manifest.name << "; logs in " << options.run_directory
            << "; Ctrl-C stops the robot, then everything\n"
            << std::flush;
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  auto next_table = std::chrono::steady_clock::now() + milliseconds(1000);
  std::size_t table_lines = 0;
  RefusalReport refusals;
  service.ready();
  while (!stop_asked && !launcher->broken()) {
    for (const auto& [component, entry] : heartbeats.entries())
      launcher->heard(component, entry.at);
    roll.vouch(*launcher);
    launcher->poll();
    service.alive(launcher->healthy(), launcher->summary());
    auto events = launcher->events();
    for (auto& news : refusals.news((*observer)->refusals())) events.push_back(std::move(news));
    if (!events.empty()) table_lines = 0;
    std::cout.clear();  // what a full disk did not take is lost, what comes later need not be
    for (const auto& event : events) std::cout << event << "\n";
    if (terminal && std::chrono::steady_clock::now() >= next_table) {
      next_table += milliseconds(1000);
      const Table table = live_table(*launcher, heartbeats);
      if (table_lines > 0) std::cout << "\033[" << table_lines << "A\033[J";
      std::cout << table.text();
      table_lines = table.size() + 1;
    }
    std::cout << std::flush;
    std::this_thread::sleep_for(milliseconds(20));
  }
  const bool broken = launcher->broken();
  service.stopping();
  std::cout << (broken ? "a component cannot be kept running; " : "")
            << "stopping: first the robot, then everything in reverse order, the base driver last\n"
            << std::flush;
  launcher->stop([&] { return standing.stands(); });
  for (const auto& event : launcher->events()) std::cout << event << "\n";
  return broken ? 1 : 0;
}

}  // namespace

void add_deployment_commands(CLI::App& app, int& exit_code) {
  auto manifests = std::make_shared<std::vector<std::string>>();
  auto* check_command =
      app.add_subcommand("check", "Judge manifests offline: wiring, rates, values, policies");
  check_command->add_option("manifest", *manifests, "Manifest files")->required();
  check_command->callback([manifests, &exit_code] { exit_code = check(*manifests); });

  auto manifest = std::make_shared<std::string>();
  auto* components_command =
      app.add_subcommand("components", "List the component types that a manifest needs");
  components_command->add_option("manifest", *manifest, "Manifest file")->required();
  components_command->callback([manifest, &exit_code] { exit_code = components(*manifest); });

  auto* graph_command = app.add_subcommand(
      "graph", "Print who sends what to whom, for graphviz (| dot -Tsvg > graph.svg)");
  graph_command->add_option("manifest", *manifest, "Manifest file")->required();
  graph_command->callback([manifest, &exit_code] { exit_code = graph(*manifest); });

  auto arguments = std::make_shared<LaunchArguments>();
  auto* launch_command = app.add_subcommand(
      "launch", "Start a deployment, watch it, restart what ends, stop it on Ctrl-C");
  launch_command->add_option("manifest", arguments->manifest, "Manifest file")->required();
  launch_command->add_option("--host", arguments->host, "Start only this host's part");
  launch_command->add_option("--set", arguments->settings,
                             "COMPONENT.PARAMETER=VALUE, over everything else");
  launch_command->add_option("--run-directory", arguments->run_directory,
                             "Parameter files, logs, memory of the components");
  launch_command->callback([arguments, &exit_code] { exit_code = launch(*arguments); });
}

}  // namespace usher::operations
