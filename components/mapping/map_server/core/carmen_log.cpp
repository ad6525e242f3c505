#include "mapping/map_server/core/carmen_log.hpp"

#include "foundation/text/compressed_text.hpp"
#include "foundation/text/words.hpp"

namespace usher::map_server {
namespace {

constexpr std::size_t kMaxBeams = 4096;

Error error_at(const std::string& name, std::size_t line, const std::string& what) {
  return {name + ":" + std::to_string(line) + ": " + what};
}

bool read_pose(Words& words, geometry::Pose2& pose) {
  return words.number(pose.x) && words.number(pose.y) && words.number(pose.yaw);
}

}  // namespace

Result<std::vector<CarmenScan>> parse_carmen_log(std::string_view text, const std::string& name) {
  std::vector<CarmenScan> scans;
  const Status status = for_each_line(text, [&](Words words, std::size_t line) -> Status {
    if (words.next() != "FLASER") return {};
    CarmenScan scan;
    scan.line = line;
    std::size_t count = 0;
    if (!words.number(count) || count > kMaxBeams) {
      return error_at(name, line, "expected a count of up to 4096 beams, found " + words.found());
    }
    scan.ranges.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (!words.number(scan.ranges[i])) {
        return error_at(name, line,
                        "expected range " + std::to_string(i + 1) + " of " + std::to_string(count) +
                            ", found " + words.found());
      }
    }
    geometry::Pose2 odom_T_base;
    if (!read_pose(words, scan.odom_T_laser) || !read_pose(words, odom_T_base)) {
      return error_at(name, line, "expected two poses after the ranges, found " + words.found());
    }
    if (!words.number(scan.time))
      return error_at(name, line, "expected a time, found " + words.found());
    scans.push_back(std::move(scan));
    return {};
  });
  if (!status) return Error{status.error()};
  return scans;
}

Result<std::vector<CarmenScan>> read_carmen_log(const std::string& path) {
  const auto text = read_compressed_text(path);
  if (!text) return Error{text.error()};
  return parse_carmen_log(*text, path);
}

Result<std::vector<geometry::Pose2>> parse_reference_poses(std::string_view text,
                                                           const std::string& name) {
  std::vector<geometry::Pose2> poses;
  const Status status = for_each_line(text, [&](Words words, std::size_t line) -> Status {
    Words first = words;
    const std::string_view word = first.next();
    if (word.empty() || word.front() == '#') return {};
    std::size_t index = 0;
    if (!words.number(index) || index != poses.size()) {
      return error_at(
          name, line,
          "expected index " + std::to_string(poses.size()) + ", found " + words.found());
    }
    double time = 0.0;
    geometry::Pose2 pose;
    if (!words.number(time) || !read_pose(words, pose)) {
      return error_at(name, line, "expected a time and a pose, found " + words.found());
    }
    poses.push_back(pose);
    return {};
  });
  if (!status) return Error{status.error()};
  return poses;
}

Result<std::vector<geometry::Pose2>> read_reference_poses(const std::string& path) {
  const auto text = read_compressed_text(path);
  if (!text) return Error{text.error()};
  return parse_reference_poses(*text, path);
}

}  // namespace usher::map_server
