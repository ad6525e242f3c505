#include "mapping/map_server/core/carmen_log.hpp"

#include <zlib.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

namespace usher::map_server {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1}
                                  << 30;  // of text: refuses what only looks like a small file
constexpr std::size_t kMaxBeams = 4096;

/// The words of one line.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    const std::size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

  /// A finite number; else the word is kept for the message.
  template <class Number>
  bool number(Number& value) {
    word_ = next();
    const auto [end, error] = std::from_chars(word_.data(), word_.data() + word_.size(), value);
    if (error != std::errc{} || end != word_.data() + word_.size()) return false;
    if constexpr (std::is_floating_point_v<Number>) return std::isfinite(value);
    return true;
  }
  std::string found() const {
    return word_.empty() ? "the end of the line" : "'" + std::string(word_.substr(0, 40)) + "'";
  }

 private:
  std::string_view rest_, word_;
};

Error error_at(const std::string& name, std::size_t line, const std::string& what) {
  return {name + ":" + std::to_string(line) + ": " + what};
}

/// Calls parse(words, line number) for each line; stops at the first error that it returns.
template <class Parse>
Status for_each_line(std::string_view text, Parse parse) {
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const Status status = parse(Words(text.substr(0, end)), line);
    if (!status) return status;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return {};
}

bool read_pose(Words& words, geometry::Pose2& pose) {
  return words.number(pose.x) && words.number(pose.y) && words.number(pose.yaw);
}

Result<std::string> read_text(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile_s*)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (file == nullptr) return Error{path + ": cannot be opened"};
  std::string text;
  std::array<char, 65536> block{};
  while (true) {
    const int count = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()));
    if (count < 0)
      return Error{path + ": damaged gzip data after " + std::to_string(text.size()) +
                   " bytes of text"};
    if (count == 0) break;
    text.append(block.data(), static_cast<std::size_t>(count));
    if (text.size() > kMaxBytes)
      return Error{path + ": expected at most " + std::to_string(kMaxBytes) + " bytes of text"};
  }
  int code = Z_OK;
  gzerror(file.get(), &code);
  if (code != Z_OK && code != Z_STREAM_END) return Error{path + ": gzip data ends early"};
  return text;
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
  const auto text = read_text(path);
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
  const auto text = read_text(path);
  if (!text) return Error{text.error()};
  return parse_reference_poses(*text, path);
}

}  // namespace usher::map_server
