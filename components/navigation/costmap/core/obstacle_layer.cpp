#include "navigation/costmap/core/obstacle_layer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace usher::costmap {

namespace {

constexpr double kFarthestStamp = 1e12;          // [s]
constexpr double kLongestPersistence = 86400.0;  // [s]
constexpr int kLongestRay = 32767;               // [cells]
constexpr double kThickest = 1.0;                // [m]
constexpr double kBeside = 0.01;                 // [m] a beam so near tells of a place
constexpr double kHidden = 0.1;  // [m] a beam that ends so much nearer tells nothing of it

std::uint32_t milliseconds(double seconds) {
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(seconds * 1000.0)));
}

std::int32_t elapsed(std::uint32_t now, std::uint32_t then) {
  return static_cast<std::int32_t>(now - then);
}

/// [m] Between a point and the line of a beam.
double off(const geometry::Point2& direction, const geometry::Point2& point) {
  return std::abs(direction.x() * point.y() - direction.y() * point.x());
}

std::string meters(double value) { return std::to_string(value) + " m"; }

}  // namespace

std::vector<geometry::Point2> beam_directions(double angle_min, double angle_increment,
                                              std::size_t count) {
  std::vector<geometry::Point2> directions(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = angle_min + static_cast<double>(i) * angle_increment;
    directions[i] = {std::cos(angle), std::sin(angle)};
  }
  return directions;
}

Status ObstacleLayer::check(const ObstacleLayerConfig& config, double resolution) {
  const double farthest = std::min(kLongestRay * resolution, 0.1 * kFarthestCoordinate);
  const auto check_range = [&](const char* what, double low, double high) -> Status {
    if (low >= 0.0 && low <= high && high < farthest) return {};
    return Error{"layer " + config.name + ": " + what + " range must be 0 <= min <= max < " +
                 meters(farthest) + ", got " + meters(low) + " .. " + meters(high)};
  };
  if (Status s = check_range("obstacle", 0.0, config.max_obstacle_range); !s.ok()) return s;
  if (Status s = check_range("raytrace", config.min_raytrace_range, config.max_raytrace_range);
      !s.ok())
    return s;
  if (!(config.thickness >= 0.0 && config.thickness <= kThickest)) {
    return Error{"layer " + config.name + ": thickness must be in [0, 1] m, got " +
                 meters(config.thickness)};
  }
  if (!(config.kept_range >= 0.0) ||
      (std::isfinite(config.kept_range) && config.kept_range > kFarthestCoordinate)) {
    return Error{"layer " + config.name + ": kept range must be in [0, 1e5] m or infinite, got " +
                 meters(config.kept_range)};
  }
  if (!(config.persistence >= 0.0 && config.persistence <= kLongestPersistence)) {
    return Error{"layer " + config.name + ": persistence must be in [0, 86400] s, got " +
                 std::to_string(config.persistence) + " s"};
  }
  return {};
}

ObstacleLayer::ObstacleLayer(ObstacleLayerConfig config, const Raster& raster)
    : config_(std::move(config)),
      states_({raster.width, raster.height, raster.resolution, 0.0, 0.0}, kUnseen),
      marked_at_(config_.persistence > 0.0 ? states_.size() : 0) {}

void ObstacleLayer::shift(int dx, int dy) {
  shift_cells(states_.values(), states_.width(), states_.height(), dx, dy, kUnseen);
  if (!marked_at_.empty()) {
    shift_cells(marked_at_, states_.width(), states_.height(), dx, dy, std::uint32_t{0});
  }
  seen_ = seen_.moved(-dx, -dy).within({0, 0, states_.width(), states_.height()});
  if (seen_.empty()) seen_ = {};  // all of it has left
}

Result<CellRect> ObstacleLayer::observe(const RangeObservation& observation, const Raster& raster) {
  assert(raster.width == states_.width() && raster.height == states_.height());
  const auto refuse = [&](const std::string& why) {
    return Error{"layer " + config_.name + ": " + why};
  };
  if (observation.ranges.size() != observation.directions.size() ||
      observation.ranges.size() > kMaxBeams) {
    return refuse("a scan must have one range per beam and at most " + std::to_string(kMaxBeams) +
                  ", got " + std::to_string(observation.ranges.size()) + " ranges for " +
                  std::to_string(observation.directions.size()) + " beams");
  }
  const geometry::Pose2& sensor = observation.sensor;
  if (!sensor.finite() || !reachable(sensor.x, sensor.y)) {
    return refuse("the sensor's pose must be finite and within 1e5 m, got (" +
                  std::to_string(sensor.x) + ", " + std::to_string(sensor.y) + ", " +
                  std::to_string(sensor.yaw) + ")");
  }
  if (!(std::abs(observation.stamp) <= kFarthestStamp)) {
    return refuse("the stamp must be finite, got " + std::to_string(observation.stamp));
  }
  CellRect touched = clear_and_collect(observation, raster);
  const std::uint32_t time = milliseconds(observation.stamp);
  if (config_.clears_only_what_all_beams_pass) restore(observation, raster);
  for (const std::uint32_t index : marks_) mark(index, time);
  seen_ = seen_.united(touched);
  return touched;
}

// Distances in cells from here on. Neighbouring beams often end in the same cell; their ray is
// traced once.
CellRect ObstacleLayer::clear_and_collect(const RangeObservation& observation,
                                          const Raster& raster) {
  const double scale = raster.cells_per_meter;
  const double c = std::cos(observation.sensor.yaw);
  const double s = std::sin(observation.sensor.yaw);
  const double x = (observation.sensor.x - raster.anchor_x) * scale;
  const double y = (observation.sensor.y - raster.anchor_y) * scale;
  const grid::Cell origin{floor_to_int(x) - raster.first_x, floor_to_int(y) - raster.first_y};
  const bool inside = states_.geometry().contains(origin);
  if (!inside && observation.clears) ++sensors_outside_;
  const bool clears = inside && observation.clears;

  const int behind = static_cast<int>(std::lround(config_.thickness / raster.resolution));
  lost_.clear();
  marks_.clear();
  marks_.reserve(observation.ranges.size() * static_cast<std::size_t>(1 + behind));
  CellBounds touched;
  grid::Cell previous{std::numeric_limits<int>::min(), 0};
  bool previous_through = false;
  for (std::size_t beam = 0; beam < observation.ranges.size(); ++beam) {
    const bool marks = !config_.negative_clears || !std::isfinite(observation.ranges[beam]) ||
                       observation.ranges[beam] >= 0.0F;
    const float range = marks ? observation.ranges[beam] : -observation.ranges[beam];
    const geometry::Point2& direction = observation.directions[beam];
    const double dx = c * direction.x() - s * direction.y();
    const double dy = s * direction.x() + c * direction.y();
    const bool directed = std::abs(dx) <= 1.001 && std::abs(dy) <= 1.001;
    if (!(range > 0.0F) || !directed) {
      invalid_ranges_ += range <= 0.0F || !directed ? 1 : 0;  // the others say: nothing is known
      continue;
    }
    const auto cell_along = [&](double distance) -> grid::Cell {
      return {floor_to_int(x + distance * scale * dx) - raster.first_x,
              floor_to_int(y + distance * scale * dy) - raster.first_y};
    };
    const bool through = range > config_.max_raytrace_range;
    const grid::Cell end = cell_along(through ? config_.max_raytrace_range : range);
    if (marks && range <= config_.max_obstacle_range) {
      for (int step = 0; step <= behind; ++step) {
        const grid::Cell hit = cell_along(range + step * raster.resolution);
        if (collect(hit)) touched.include(hit);
      }
    }
    if (!clears || (end == previous && through == previous_through)) continue;
    previous = end;
    previous_through = through;
    trace(origin, end, first_cleared(origin, end, scale), through);
    touched.include(end);
  }
  if (previous.x != std::numeric_limits<int>::min()) touched.include(origin);
  return touched.rect().within(raster.all());
}

/// Notes an echo to be marked; false when there is nothing new to mark.
bool ObstacleLayer::collect(grid::Cell hit) {
  if (!states_.geometry().contains(hit)) return false;
  const auto index = static_cast<std::uint32_t>(states_.geometry().index(hit));
  if (!marks_.empty() && marks_.back() == index) return false;
  marks_.push_back(index);
  return true;
}

/// Marks again what the lines crossed and not all beams passed.
void ObstacleLayer::restore(const RangeObservation& observation, const Raster& raster) {
  const geometry::Pose2 sensor_T_window = geometry::inverse(observation.sensor);
  for (const std::uint32_t index : lost_) {
    const geometry::Point2 place = sensor_T_window * raster.center(states_.geometry().cell(index));
    if (!passed(observation, place, place.norm() - kHidden)) states_[index] = kSeenOccupied;
  }
}

/// Whether the nearest beams on both sides of a point, in the sensor's frame, and all within
/// kBeside of it reach as far as `least` [m].
bool ObstacleLayer::passed(const RangeObservation& observation, const geometry::Point2& point,
                           double least) {
  const auto& directions = observation.directions;
  const auto tells = [&](std::size_t beam) {
    return observation.ranges[beam] > 0.0F && observation.ranges[beam] >= least;
  };
  const auto beside = [&](std::size_t beam) { return off(directions[beam], point) <= kBeside; };
  std::size_t nearest = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t beam = 0; beam < directions.size(); ++beam) {
    const double along = directions[beam].dot(point);
    if (along > most) most = along, nearest = beam;
  }
  std::size_t first = nearest - (nearest > 0 ? 1 : 0);
  std::size_t last = std::min(nearest + 1, directions.size() - 1);
  while (first > 0 && beside(first - 1)) --first;
  while (last + 1 < directions.size() && beside(last + 1)) ++last;
  for (std::size_t beam = first; beam <= last; ++beam) {
    if (!tells(beam)) return false;
  }
  return true;
}

/// Whether a beam leads to a point in the sensor's frame.
bool ObstacleLayer::looks_at(const RangeObservation& observation, const geometry::Point2& point) {
  return std::ranges::any_of(observation.directions, [&](const geometry::Point2& direction) {
    return direction.dot(point) > 0.0 && off(direction, point) <= kBeside;
  });
}

/// Obstacles beside the places that are `gone(cell)` get another state.
template <class Gone>
CellRect ObstacleLayer::forget_beside(std::span<const geometry::Point2> places, double reach,
                                      const Raster& raster, std::uint8_t state, const Gone& gone) {
  CellRect touched;
  if (!has_obstacles_) return touched;
  const int cells = static_cast<int>(std::ceil(reach * raster.cells_per_meter));
  for (const geometry::Point2& place : places) {
    if (!reachable(place.x(), place.y())) continue;
    const grid::Cell middle = raster.cell_at(place.x(), place.y());
    const CellRect near =
        CellRect{middle.x, middle.y, middle.x + 1, middle.y + 1}.grown(cells).within(seen_);
    for (int y = near.y0; y < near.y1; ++y) {
      for (int x = near.x0; x < near.x1; ++x) {
        std::uint8_t& cell = states_.row(y)[x];
        if (cell != kSeenOccupied || !gone(grid::Cell{x, y})) continue;
        cell = state;
        touched = touched.united({x, y, x + 1, y + 1});
      }
    }
  }
  return touched;
}

CellRect ObstacleLayer::forget_passed(const RangeObservation& observation,
                                      std::span<const geometry::Point2> places, double reach,
                                      const Raster& raster) {
  const geometry::Pose2 sensor_T_window = geometry::inverse(observation.sensor);
  return forget_beside(places, reach, raster, kSeenFree, [&](grid::Cell cell) {
    const geometry::Point2 center = sensor_T_window * raster.center(cell);
    // Its own echo is no farther than the cell.
    return looks_at(observation, center) &&
           passed(observation, center, center.norm() + raster.resolution);
  });
}

CellRect ObstacleLayer::forget_since(double since, std::span<const geometry::Point2> places,
                                     double reach, const Raster& raster) {
  assert(std::abs(since) <= kFarthestStamp);
  const std::uint32_t time = milliseconds(since);
  return forget_beside(places, reach, raster, kUnseen, [&](grid::Cell cell) {
    return marked_at_.empty() || elapsed(marked_at_[states_.geometry().index(cell)], time) >= 0;
  });
}

/// The number of the first cell of a line that is not nearer than the minimum raytrace range.
int ObstacleLayer::first_cleared(grid::Cell from, grid::Cell to, double cells_per_meter) const {
  if (config_.min_raytrace_range <= 0.0) return 0;
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double major = std::max(std::abs(dx), std::abs(dy));
  if (major == 0.0) return 1;
  const double shortest = config_.min_raytrace_range * cells_per_meter;
  return static_cast<int>(std::ceil(shortest * major / std::hypot(dx, dy)));
}

// Clears cell number first, first + 1, ... of the line from one cell to another
// [bresenham1965line]: number i lies i cells along the longer axis and i * minor / major along the
// other, rounded to nearest (ties towards `from`). In 32 fraction bits that is exact for lines up
// to 32767 cells: what the rounded slope loses stays below 2^-17 of a cell, and no line comes
// closer than 2^-16 to a tie without meeting it. The last cell is cleared only for a beam that went
// through it. The start lies in the window; the line is cut where it leaves it.
void ObstacleLayer::trace(grid::Cell from, grid::Cell to, int first, bool through) {
  const int width = states_.width();
  const int height = states_.height();
  const int dx = to.x - from.x;
  const int dy = to.y - from.y;
  const bool steep = std::abs(dy) > std::abs(dx);
  const int major = steep ? std::abs(dy) : std::abs(dx);
  const int minor = steep ? std::abs(dx) : std::abs(dy);
  const int room_x = dx < 0 ? from.x : width - 1 - from.x;
  const int room_y = dy < 0 ? from.y : height - 1 - from.y;
  const std::int64_t half = (std::int64_t{1} << 31) - 1;
  const std::int64_t slope = major > 0 ? (static_cast<std::int64_t>(minor) << 32) / major : 0;
  std::int64_t count =
      std::min<std::int64_t>(through ? major + 1 : major, (steep ? room_y : room_x) + 1);
  const std::int64_t room = steep ? room_x : room_y;
  if (minor > room) count = std::min(count, (((room + 1) << 32) - 1 - half) / slope + 1);
  if (first >= count) return;

  const std::ptrdiff_t step_x = dx < 0 ? -1 : 1;
  const std::ptrdiff_t step_y = dy < 0 ? -width : width;
  const std::ptrdiff_t step = steep ? step_y : step_x;
  const std::ptrdiff_t side = steep ? step_x : step_y;
  std::uint8_t* cell = states_.data() + states_.geometry().index(from) + first * step;
  std::int64_t position = half + first * slope;
#pragma GCC unroll 4
  for (std::int64_t left = count - first; left > 0; --left) {
    std::uint8_t& state = cell[(position >> 32) * side];
    if (state == kSeenOccupied)
      lost_.push_back(static_cast<std::uint32_t>(&state - states_.data()));
    state = kSeenFree;
    cell += step;
    position += slope;
  }
}

void ObstacleLayer::mark(std::size_t index, std::uint32_t time) {
  states_[index] = kSeenOccupied;
  has_obstacles_ = true;
  if (marked_at_.empty()) return;
  marked_at_[index] = time;
  const std::uint32_t end = time + milliseconds(config_.persistence);
  if (!has_deadline_ || elapsed(deadline_, end) > 0) deadline_ = end;
  has_deadline_ = true;
}

Result<CellRect> ObstacleLayer::replace(std::span<const geometry::Point2> points, double stamp,
                                        const Raster& raster) {
  if (!(std::abs(stamp) <= kFarthestStamp)) {
    return Error{"layer " + config_.name + ": the stamp must be finite, got " +
                 std::to_string(stamp)};
  }
  const CellRect wiped = forget();
  for (const geometry::Point2& point : points) {
    if (!reachable(point.x(), point.y())) {
      ++invalid_ranges_;
      continue;
    }
    const grid::Cell cell = raster.cell_at(point.x(), point.y());
    if (!states_.geometry().contains(cell)) continue;
    mark(states_.geometry().index(cell), milliseconds(stamp));
    seen_ = seen_.united({cell.x, cell.y, cell.x + 1, cell.y + 1});
  }
  return wiped.united(seen_);
}

CellRect ObstacleLayer::expire(double now) {
  assert(std::abs(now) <= kFarthestStamp);
  if (!has_deadline_) return {};
  const std::uint32_t time = milliseconds(now);
  if (elapsed(time, deadline_) < 0) return {};
  const auto persistence = static_cast<std::int32_t>(milliseconds(config_.persistence));
  has_deadline_ = false;
  CellRect touched;
  for (int y = seen_.y0; y < seen_.y1; ++y) {
    for (int x = seen_.x0; x < seen_.x1; ++x) {
      const std::size_t index = states_.geometry().index({x, y});
      if (states_[index] != kSeenOccupied) continue;
      if (elapsed(time, marked_at_[index]) >= persistence) {
        states_[index] = kUnseen;
        touched = touched.united({x, y, x + 1, y + 1});
      } else {
        const std::uint32_t end = marked_at_[index] + static_cast<std::uint32_t>(persistence);
        if (!has_deadline_ || elapsed(deadline_, end) > 0) deadline_ = end;
        has_deadline_ = true;
      }
    }
  }
  return touched;
}

CellRect ObstacleLayer::forget(const CellRect& kept) {
  const CellRect wiped = seen_, inside = kept.within(seen_);
  for (int y = wiped.y0; y < wiped.y1; ++y) {
    const bool crosses = !inside.empty() && y >= inside.y0 && y < inside.y1;
    std::uint8_t* const row = states_.row(y);
    for (int x = wiped.x0; x < wiped.x1; ++x) {
      const bool stays = crosses && x >= inside.x0 && x < inside.x1 && row[x] == kSeenOccupied;
      if (!stays) row[x] = kUnseen;
    }
  }
  seen_ = inside.empty() ? CellRect{} : inside;
  has_deadline_ = has_deadline_ && !seen_.empty();
  return wiped;
}

void ObstacleLayer::set_free(int y, int x0, int x1) {
  std::fill(states_.row(y) + x0, states_.row(y) + x1, kSeenFree);
  seen_ = seen_.united({x0, y, x1, y + 1});
}

}  // namespace usher::costmap
