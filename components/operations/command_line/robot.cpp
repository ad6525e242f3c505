#include "operations/command_line/robot.hpp"

#include <unistd.h>

#include <filesystem>

#include "operations/launcher/launcher.hpp"
#include "operations/security/permissions.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::operations {

namespace {

/// Of the command line; set before any command runs.
std::string& keys_option() {
  static std::string keys;
  return keys;
}

}  // namespace

void add_robot_options(CLI::App& app) {
  app.add_option("--keys", keys_option(),
                 "Folder of `usher keys`: to launch with, or of a robot launched elsewhere");
}

std::string keys_folder() {
  std::error_code ignored;
  return keys_option().empty()
             ? ""
             : std::filesystem::absolute(keys_option(), ignored).lexically_normal().string();
}

runtime::Observer::Options reach_robot(const std::string& name, std::uint32_t domain) {
  runtime::Observer::Options options{.name = name, .domain = domain};
  for (const auto& path : operator_files(domain)) {
    if (access(path.c_str(), R_OK) != 0) continue;
    const auto file = runtime::read_parameter_file(path);
    if (!file) continue;
    options.host = file->host;
    options.peers = file->peers;
    options.discovery_server = file->discovery_server;
    options.clock_anchor = file->clock_anchor;
    options.identity = file->identity;
    break;
  }
  if (!keys_option().empty()) options.identity = keys_folder() + "/" + kOperator;
  return options;
}

std::string nobody_there(const std::string& who, std::uint32_t domain) {
  std::string text = "no " + who + " in domain " + std::to_string(domain);
  for (const std::uint32_t other : launched_domains()) {
    if (other == domain) continue;
    text += "; a robot was launched here in domain " + std::to_string(other) + ": --domain " +
            std::to_string(other);
  }
  return text;
}

}  // namespace usher::operations
