#include "operations/people_study/leg_scans.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "foundation/text/compressed_text.hpp"
#include "foundation/text/words.hpp"

namespace usher::people_study {

namespace {

using geometry::Point2;

constexpr std::size_t kMostBeams = 4096;
constexpr std::size_t kMostLegs = 64;
constexpr double kJump = 0.10;                       // [m]
constexpr double kNarrowest = 0.06, kWidest = 0.22;  // [m]
constexpr double kStands = 0.3;                      // share of the scans
constexpr double kCell = 0.05;                       // [m]

struct Laser {
  double angle_min = NAN, angle_increment = NAN, range_min = NAN, range_max = NAN;
};

Laser read_head(Words words) {
  Laser laser;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    double* value = word == "angle_min"   ? &laser.angle_min
                    : word == "angle_inc" ? &laser.angle_increment
                    : word == "range_min" ? &laser.range_min
                    : word == "range_max" ? &laser.range_max
                                          : nullptr;
    if (value != nullptr && !words.number(*value)) *value = NAN;
  }
  return laser;
}

Status read_scan(Words& words, const Laser& laser, MarkedScan& scan) {
  if (!words.number(scan.time)) return Error{"expected a time, found " + words.found()};
  for (float range = 0.0F; words.any_number(range);) {
    if (scan.ranges.size() == kMostBeams)
      return Error{"expected at most " + std::to_string(kMostBeams) + " ranges"};
    const bool near = static_cast<double>(range) < laser.range_min;
    scan.ranges.push_back(near ? std::numeric_limits<float>::quiet_NaN() : range);
  }
  if (words.found() != "the end of the line")
    return Error{"expected a range, found " + words.found()};
  return {};
}

Status read_legs(Words& words, std::vector<Point2>& legs) {
  double time = 0.0;
  std::size_t count = 0;
  if (!words.number(time) || !words.number(count) || count > kMostLegs)
    return Error{"expected a time and a count of up to " + std::to_string(kMostLegs) + ", found " +
                 words.found()};
  for (std::size_t i = 0; i < count; ++i) {
    Point2 leg;
    if (!words.number(leg.x()) || !words.number(leg.y()))
      return Error{"expected x and y of leg " + std::to_string(i + 1) + ", found " + words.found()};
    legs.push_back(leg);
  }
  return {};
}

/// Calls `meet(point)` for each beam that meets something.
template <class Meet>
void for_each_point(const people_detector::ScanView& scan, double farthest, Meet meet) {
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    const double angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    if (range > 0.0 && range <= farthest)
      meet(i, Point2(range * std::cos(angle), range * std::sin(angle)));
  }
}

}  // namespace

Result<LegRecording> parse_leg_recording(std::string_view text, const std::string& name) {
  LegRecording recording{name, 0.0, 0.0, {}};
  Laser laser;
  const Status status = for_each_line(text, [&](Words words, std::size_t line) -> Status {
    const std::string_view kind = words.next();
    Status read;
    if (kind == "#") {
      laser = read_head(words);
    } else if (kind == "S") {
      if (!std::isfinite(laser.angle_min) || !(laser.angle_increment > 0.0) ||
          !std::isfinite(laser.range_min))
        read = Error{"expected a line '# angle_min .. angle_inc .. range_min ..' before"};
      else
        read = read_scan(words, laser, recording.scans.emplace_back());
    } else if (kind == "L") {
      read = recording.scans.empty() ? Status(Error{"expected a scan before its marks"})
                                     : read_legs(words, recording.scans.back().legs);
    } else if (!kind.empty()) {
      read = Error{"expected #, S or L, found '" + std::string(kind.substr(0, 40)) + "'"};
    }
    if (!read) return Error{name + ":" + std::to_string(line) + ": " + read.error()};
    return {};
  });
  if (!status) return Error{status.error()};
  recording.angle_min = laser.angle_min;
  recording.angle_increment = laser.angle_increment;
  return recording;
}

Result<std::vector<LegRecording>> read_leg_recordings(const std::string& folder) {
  constexpr std::string_view kEnding = ".txt.gz";
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(kEnding)) names.push_back(name.substr(0, name.size() - kEnding.size()));
  }
  if (names.empty()) return Error{folder + ": no *.txt.gz"};
  std::sort(names.begin(), names.end());
  std::vector<LegRecording> recordings;
  for (const std::string& name : names) {
    const std::string path = folder + "/" + name + std::string(kEnding);
    const auto text = read_compressed_text(path);
    if (!text) return Error{text.error()};
    auto recording = parse_leg_recording(*text, path);
    if (!recording) return Error{recording.error()};
    recording->name = name;
    recordings.push_back(std::move(recording).value());
  }
  return recordings;
}

std::vector<Point2> legs_by_width(const people_detector::ScanView& scan, double farthest) {
  std::vector<Point2> legs;
  Point2 first, last, sum;
  std::size_t beams = 0, next = 0;
  const auto finish = [&] {
    const double width = beams > 0 ? (last - first).norm() : 0.0;
    if (width >= kNarrowest && width <= kWidest) legs.push_back(sum / static_cast<double>(beams));
  };
  for_each_point(scan, farthest, [&](std::size_t beam, const Point2& point) {
    if (beams == 0 || beam != next || (point - last).norm() > kJump) {
      finish();
      first = point, sum = Point2::Zero(), beams = 0;
    }
    sum += point, last = point, ++beams, next = beam + 1;
  });
  finish();
  return legs;
}

grid::OccupancyGrid map_of(const LegRecording& recording, double farthest) {
  const int side = 2 * static_cast<int>(std::ceil(farthest / kCell)) + 2;
  const grid::GridGeometry geometry{side, side, kCell, -0.5 * kCell * side, -0.5 * kCell * side};
  grid::Grid<int> met(geometry, 0);
  std::vector<std::size_t> cells;
  for (const MarkedScan& scan : recording.scans) {
    cells.clear();
    for_each_point(recording.view(scan), farthest, [&](std::size_t, const Point2& point) {
      cells.push_back(geometry.index(geometry.cell_at(point)));
    });
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    for (const std::size_t cell : cells) ++met[cell];
  }
  grid::OccupancyGrid map(geometry, grid::kFree);
  const auto least = kStands * static_cast<double>(recording.scans.size());
  for (std::size_t i = 0; i < map.size(); ++i)
    if (static_cast<double>(met[i]) > least) map[i] = grid::kOccupied;
  return map;
}

}  // namespace usher::people_study
