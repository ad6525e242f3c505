#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

#include "idl/topics.hpp"
#include "operations/command_line/commands.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/command_line/table.hpp"
#include "operations/launcher/launcher.hpp"
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
    const auto deployment = load_deployment(path, installation, {});
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
      std::cout << path << ": good, " << deployment->manifest.components.size() << " components on "
                << deployment->manifest.hosts.size() << " hosts\n";
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

/// The data flow in the language of graphviz: components as boxes in their hosts, topics as edges.
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
        std::cout << "  \"" << writer << "\" -> \"" << component.name << "\" [label=\""
                  << input.topic << "\"];\n";
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

/// One datagram to systemd where it started this program (sd_notify's protocol): that it is up, and
/// in every round that it still goes round, so that WatchdogSec restarts a launcher that hangs.
void tell_service_manager(std::string_view state) {
  const char* path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t size = path == nullptr ? 0 : std::strlen(path);
  if (size < 2 || size >= sizeof(address.sun_path)) return;
  std::memcpy(address.sun_path, path, size);
  if (path[0] == '@') address.sun_path[0] = '\0';  // an abstract name
  static const int handle = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  static_cast<void>(!sendto(handle, state.data(), state.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                            reinterpret_cast<const sockaddr*>(&address),
                            static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + size)));
}

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
  const auto deployment = load_deployment(arguments.manifest, installation, overrides);
  if (!deployment) return fail(deployment.error());
  for (const auto& finding : deployment->findings) {
    std::cerr << to_string(finding) << "\n";
  }
  if (!deployment->findings.empty())
    return fail("this deployment could not work; nothing was started");

  LaunchOptions options{arguments.host, installation.programs, arguments.run_directory};
  if (options.run_directory.empty())
    options.run_directory = default_run_directory(deployment->manifest.domain, arguments.host);
  auto launcher = Launcher::create(*deployment, options);
  if (!launcher) return fail(launcher.error());

  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = true; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  Heartbeats heartbeats;
  auto observer = runtime::Observer::create(
      {.name = "launcher", .host = arguments.host, .domain = deployment->manifest.domain});
  if (!observer) return fail(observer.error());
  const auto reader = (*observer)->reader(
      topics::kHeartbeat, [&](const auto& message, const auto&) { heartbeats.take(message); });
  if (!reader) return fail(reader.error());

  std::cout << "launching " << deployment->manifest.name << "; logs in " << options.run_directory
            << "; Ctrl-C stops\n"
            << std::flush;
  tell_service_manager("READY=1");
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  auto next_table = std::chrono::steady_clock::now() + milliseconds(1000);
  std::size_t table_lines = 0;
  while (!stop_asked && !launcher->broken()) {
    for (const auto& [component, entry] : heartbeats.entries())
      launcher->heard(component, entry.at);
    launcher->poll();
    tell_service_manager("WATCHDOG=1");
    const auto events = launcher->events();
    if (!events.empty()) table_lines = 0;
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
  std::cout << (broken ? "a component cannot be kept running; stopping all\n" : "stopping\n")
            << std::flush;
  launcher->stop();
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
