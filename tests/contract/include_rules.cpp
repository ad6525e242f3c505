#include "contract/include_rules.hpp"

#include <algorithm>
#include <array>
#include <regex>
#include <sstream>

namespace usher::contract {
namespace {

/// Where a file lives: "runtime/dds/x.cpp" -> room "runtime", layer "dds";
/// "navigation/costmap/core/x.cpp" -> room "navigation/costmap", layer "core".
struct Place {
  std::string room, layer;
};

bool is_single_room(std::string_view name) {
  constexpr std::array<std::string_view, 4> kRooms{"runtime", "wire", "foundation", "operations"};
  return std::find(kRooms.begin(), kRooms.end(), name) != kRooms.end();
}

Place place_of(std::string_view path) {
  std::vector<std::string> parts;
  std::istringstream stream{std::string(path)};
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  const std::size_t depth = is_single_room(parts.front()) ? 1 : 2;
  Place place;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (i < depth) place.room += (i == 0 ? "" : "/") + parts[i];
    if (i == depth && i + 1 < parts.size()) place.layer = parts[i];
  }
  return place;
}

bool starts_with_any(std::string_view text, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view each) { return text.starts_with(each); });
}

bool is_message(std::string_view name) {
  return starts_with_any(name, {"idl/", "ros2.h", "usher_msgs.h", "usher_sim_msgs.h"});
}

/// A component's core, or foundation: pure computation. Tests of both may read files and time.
bool is_pure(const Place& place, std::string_view path) {
  if (path.find("/test/") != std::string_view::npos) return false;
  return place.room == "foundation" || place.layer == "core";
}

std::string own_rule(const Place& from, std::string_view name, bool test) {
  if (test && starts_with_any(name, {"support/", "wire/", "runtime/", "foundation/"})) return {};
  if (starts_with_any(name, {"foundation/"})) return {};
  if (from.room == "foundation") return "foundation stands on nothing but itself";
  if (from.room == "runtime") {
    return starts_with_any(name, {"runtime/"}) || is_message(name)
               ? ""
               : "runtime knows no component and no wire conversion";
  }
  if (from.room == "wire") {
    return starts_with_any(name, {"wire/", "runtime/api/"}) || is_message(name)
               ? ""
               : "wire knows messages, foundation types and the runtime's api";
  }
  if (starts_with_any(name, {from.room + "/"})) {
    const bool up = from.layer == "core" && !test && !starts_with_any(name, {from.room + "/core/"});
    return up ? "a core does not know its shell" : "";
  }
  // Libraries are no components; those of drivers, tasks and texts have what shells share, too.
  if (starts_with_any(name, {"drivers/base_obedience/core/", "drivers/laser_scanner/core/",
                             "drivers/serial_frame/core/", "interaction/finger/core/",
                             "interaction/own_stop/core/", "interaction/phrases/core/",
                             "simulation/rendering/core/", "tasks/service/core/"})) {
    return {};
  }
  if (from.room.starts_with("tasks/") && from.layer == "shell" &&
      name.starts_with("tasks/service/shell/")) {
    return {};
  }
  if (from.layer == "shell" && name.starts_with("interaction/phrases/shell/")) return {};
  // Who grants and who tells of it judge the base by the same parameters.
  if (from.room.starts_with("control/") && from.layer == "shell" &&
      name == "drivers/base_obedience/shell/read_response.hpp") {
    return {};
  }
  if (from.room.starts_with("drivers/") && from.layer != "core" &&
      starts_with_any(name, {"drivers/base_obedience/shell/", "drivers/laser_scanner/shell/"})) {
    return {};
  }
  if (from.layer == "core" && !test) return "a core knows itself and foundation";
  if (starts_with_any(name, {"wire/", "runtime/api/"}) || is_message(name)) return {};
  // A component with a main program of its own: a device that wants the main thread.
  if (from.layer == "program" && name == "runtime/dds/component_main.hpp") return {};
  // A simulated visitor speaks with the voice that the robot has.
  if (from.room == "simulation/visitor" && from.layer == "program" &&
      starts_with_any(name, {"interaction/speech/engine/", "interaction/speech/core/"})) {
    return {};
  }
  if (starts_with_any(name, {"runtime/"})) return "a shell knows the runtime's api only";
  return test ? "what needs another component is tested below tests/"
              : "a component does not know another one";
}

}  // namespace

std::string include_breach(std::string_view path, std::string_view include) {
  const Place from = place_of(path);
  const bool test = path.find("/test/") != std::string_view::npos;
  const std::string name(include.substr(1, include.size() - 2));
  if (include.front() == '<') {
    if (starts_with_any(name, {"fastrtps/", "fastdds/", "fastcdr/"}) &&
        !(from.room == "runtime" && from.layer == "dds")) {
      return "only runtime/dds knows Fast DDS";
    }
    if (is_pure(from, path) &&
        starts_with_any(name, {"spdlog/", "thread", "mutex", "future", "atomic",
                               "condition_variable", "sys/", "unistd.h"})) {
      return "a core computes: no threads, no logging, no system calls";
    }
    // Parsers of map and world files may read YAML.
    const bool parser = path.find("_file.cpp") != std::string_view::npos;
    if (is_pure(from, path) && starts_with_any(name, {"yaml-cpp/"}) && !parser) {
      return "a core reads no YAML, except a parser of files (*_file.cpp)";
    }
    return {};
  }
  if (from.room == "operations") return {};
  // A test may include what lies beside it by its bare name.
  if (test && name.find('/') == std::string::npos) return {};
  if (name.find('/') == std::string::npos && !is_message(name)) {
    return "include paths start at components/";
  }
  return own_rule(from, name, test);
}

std::string word_breach(std::string_view path, std::string_view line) {
  if (!is_pure(place_of(path), path)) return {};
  static const std::regex kForbidden(
      R"(\b(getenv|random_device|steady_clock|system_clock|high_resolution_clock|clock_gettime|normal_distribution|this_thread)\b)");
  const std::string code(line.substr(0, line.find("//")));
  std::smatch match;
  if (!std::regex_search(code, match, kForbidden)) return {};
  return "a core does not use " + match.str();
}

std::vector<std::string> includes_of(const std::string& text) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s+([<"][^>"]+[>"]))re");
  std::vector<std::string> result;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::smatch match;
    if (std::regex_search(line, match, kInclude)) result.push_back(match[1]);
  }
  return result;
}

}  // namespace usher::contract
