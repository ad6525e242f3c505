#include "runtime/dds/discovery_server.hpp"

#include <signal.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "runtime/dds/participant.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

int discovery_server_main(int argc, char** argv) {
  constexpr int kWrong = 2;
  const auto wrong = [](const std::string& why) {
    std::fprintf(stderr, "usher-discovery_server: %s\n", why.c_str());
    return kWrong;
  };
  CLI::App app{"Where the participants of a robot find one another", "usher-discovery_server"};
  std::string path;
  app.add_option("--parameters", path, "File that the launcher wrote")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::fputs(app.help().c_str(), stdout);
    return 0;
  } catch (const CLI::ParseError& error) {
    return wrong(error.what());
  }
  const auto file = read_parameter_file(path);
  if (!file) return wrong(file.error());
  if (file->discovery_server.empty()) return wrong(path + " names no address to serve at");

  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGINT);
  sigaddset(&ends, SIGTERM);
  sigprocmask(SIG_BLOCK, &ends, nullptr);  // before the library's threads, which inherit it
  const auto server = Participant::create({.name = file->name,
                                           .host = file->host,
                                           .domain = file->domain,
                                           .peers = {},
                                           .discovery_server = file->discovery_server,
                                           .identity = file->identity,
                                           .serves_discovery = true},
                                          MonotonicClock(file->clock_anchor));
  if (!server) return wrong(server.error());
  int signal = 0;
  sigwait(&ends, &signal);
  return 0;
}

}  // namespace usher::runtime
