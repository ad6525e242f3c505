#include "runtime/dds/component_main.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "runtime/contract/describe.hpp"
#include "runtime/dds/contract_text.hpp"
#include "runtime/dds/dds_host.hpp"

namespace usher::runtime {
namespace {

constexpr int kDone = 0;
constexpr int kWrong = 2;
constexpr int kFault = 3;

StopFlag& stop_flag() {
  static StopFlag flag;
  return flag;
}
void on_signal(int) { stop_flag().set(); }

void stop_on_signals() {
  stop_flag();  // made before a signal needs it
  struct sigaction action {};
  action.sa_handler = on_signal;
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

int report(int code, const std::string& who, const std::string& error) {
  std::fprintf(stderr, "%s: %s\n", who.c_str(), error.c_str());
  return code;
}

ParameterFile defaults(const ComponentFactory& factory) {
  ParameterFile file;
  file.component = factory.type;
  file.name = factory.type;
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  file.host = host.data();
  return file;
}

int run_component(const ComponentFactory& factory, ParameterFile file) {
  const std::string name = file.name;
  auto host = DdsHost::create(std::move(file), stop_flag());
  if (!host) return report(kWrong, name, host.error());
  if (const Status status = (*host)->construct(factory); !status) {
    return report((*host)->engine().faulted() ? kFault : kWrong, name, status.error());
  }
  const int code = (*host)->run();
  if (code == kFault) return report(code, name, "fault: " + (*host)->engine().fault_reason());
  return code;
}

int print_contract(const ComponentFactory& factory, bool for_people) {
  const auto contract = describe(factory);
  if (!contract) return report(kWrong, factory.type, contract.error());
  const std::string text = for_people ? to_table(*contract) : to_yaml(*contract);
  std::fwrite(text.data(), 1, text.size(), stdout);
  return kDone;
}

}  // namespace

int component_main(const ComponentFactory& factory, int argc, char** argv) {
  CLI::App app{"usher component " + factory.type, "usher-" + factory.type};
  std::string path;
  bool judges = false;
  bool contract = false;
  bool help = false;
  bool version = false;
  app.set_help_flag();
  app.add_option("--parameters", path, "File that the launcher wrote for this component");
  app.add_flag("--judge", judges, "Tell what this component refuses of the file, and end");
  app.add_flag("--contract", contract, "Print ports, timers and parameters as YAML");
  app.add_flag("-h,--help", help, "Print options, ports and parameters");
  app.add_flag("--version", version, "Print the version");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report(kWrong, "usher-" + factory.type, error.what());
  }
  if (version) return std::printf("usher-%s %s\n", factory.type.c_str(), USHER_VERSION), kDone;
  if (contract) return print_contract(factory, false);
  if (help) {
    const std::string text = app.help();
    std::fwrite(text.data(), 1, text.size(), stdout);
    return print_contract(factory, true);
  }
  ParameterFile file = defaults(factory);
  if (!path.empty()) {
    auto read = read_parameter_file(path);
    if (!read) return report(kWrong, "usher-" + factory.type, read.error());
    file = std::move(read).value();
    if (file.component != factory.type) {
      return report(kWrong, "usher-" + factory.type,
                    path + ": is for component '" + file.component + "'");
    }
  }
  if (judges) {
    const Status status = judge(factory, file);
    return status ? kDone : report(kWrong, file.name, status.error());
  }
  stop_on_signals();
  return run_component(factory, std::move(file));
}

int group_main(std::span<const ComponentFactory> factories, int argc, char** argv) {
  CLI::App app{"several usher components in one process", "usher-group"};
  std::vector<std::string> paths;
  app.add_option("--parameters", paths, "One file for each component")->required()->take_all();
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(app.help().c_str(), stdout);
    return kDone;
  } catch (const CLI::ParseError& error) {
    return report(kWrong, "usher-group", error.what());
  }
  std::vector<std::pair<const ComponentFactory*, ParameterFile>> members;
  for (const std::string& path : paths) {
    auto file = read_parameter_file(path);
    if (!file) return report(kWrong, "usher-group", file.error());
    const auto factory = std::ranges::find(factories, file->component, &ComponentFactory::type);
    if (factory == factories.end()) {
      return report(kWrong, "usher-group",
                    path + ": component '" + file->component + "' is not in this program");
    }
    members.emplace_back(&*factory, std::move(file).value());
  }
  stop_on_signals();
  std::atomic<int> code{kDone};
  std::vector<std::thread> threads;
  threads.reserve(members.size());
  for (auto& [factory, file] : members) {
    threads.emplace_back([&code, factory = factory, file = std::move(file)]() mutable {
      const int ended = run_component(*factory, std::move(file));
      int expected = kDone;
      code.compare_exchange_strong(expected, ended);  // the first that failed decides
      stop_flag().set();
    });
  }
  for (std::thread& thread : threads) thread.join();
  return code;
}

}  // namespace usher::runtime
