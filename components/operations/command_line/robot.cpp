#include "operations/command_line/robot.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>

#include "foundation/text/suggestion.hpp"
#include "idl/topics.hpp"
#include "operations/command_line/table.hpp"
#include "operations/command_line/usage.hpp"
#include "operations/launcher/run_places.hpp"
#include "operations/security/permissions.hpp"
#include "runtime/parameters/parameter_file.hpp"
#include "wire/conversions.hpp"

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

void add_domain_option(CLI::App& command, std::optional<std::uint32_t>& given) {
  command
      .add_option("--domain", given,
                  "DDS domain; else that of the only robot launched on this machine, else 0")
      ->check(domain_number());
}

MeantDomain meant_domain(const std::optional<std::uint32_t>& given,
                         const std::vector<std::uint32_t>& launched) {
  if (!given && launched.size() == 1) {
    const std::uint32_t only = launched.front();
    const std::string text =
        "in domain " + std::to_string(only) + ", where the only robot of this machine was launched";
    return {only, only == 0 ? "" : text};
  }
  const std::uint32_t domain = given.value_or(0);
  const bool there = std::ranges::find(launched, domain) != launched.end();
  if (launched.empty() || (given && there)) return {domain, ""};
  std::string text = (there ? "in domain " : "no robot was launched on this machine in domain ") +
                     std::to_string(domain);
  const char* before = "; one was in domain ";
  for (const std::uint32_t other : launched) {
    if (other == domain) continue;
    text += before + std::to_string(other) + " (--domain " + std::to_string(other) + ")";
    before = ", one in domain ";
  }
  return {domain, text};
}

std::uint32_t meant_domain(const std::optional<std::uint32_t>& given) {
  const MeantDomain meant = meant_domain(given, launched_domains());
  if (!meant.remark.empty()) std::cerr << "usher: " << meant.remark << "\n";
  return meant.domain;
}

std::string nobody_there(const std::string& who, std::uint32_t domain) {
  return "no " + who + " in domain " + std::to_string(domain);
}

std::string nobody_writes(const std::string& topic, std::uint32_t domain,
                          const std::vector<std::string>& written) {
  return "nobody writes " + topic + " in domain " + std::to_string(domain) +
         suggestion(topic, written);
}

Status judge_place(runtime::Observer& observer, double x, double y) {
  auto reader = observer.reader(topics::kMap);
  if (!reader) return Error{reader.error()};
  const auto map = reader->take(std::chrono::seconds(3));
  if (!map) return {};
  const auto origin = wire::to_planar(map->info().origin());
  if (!origin) return {};
  const double resolution = map->info().resolution();
  const double width = resolution * map->info().width();
  const double height = resolution * map->info().height();
  const geometry::Point2 there = geometry::inverse(*origin) * geometry::Point2(x, y);
  if (there.x() >= 0.0 && there.y() >= 0.0 && there.x() < width && there.y() < height) return {};
  return Error{format("(%.2f, ", x) + format("%.2f) m is outside the map", y) +
               format(" of %.2f", width) + format(" x %.2f m", height) +
               format(" from (%.2f, ", origin->x) + format("%.2f) on", origin->y)};
}

Status judge_pace(double pace, float fastest) {
  if (static_cast<float>(pace) <= fastest) return {};
  return Error{"--max-speed must be at most this robot's " + format("%.2f m/s", fastest) +
               format(", got %g m/s", pace)};
}

}  // namespace usher::operations
