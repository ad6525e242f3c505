#include "mapping/map_server/core/map_from_scans.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "foundation/grid/ray_cast.hpp"

namespace usher::map_server {
namespace {

constexpr int kGrowth = 128;       // [cells] the grid grows by at least this
constexpr double kFarthest = 1e6;  // [m] coordinates beyond are no place in a building

}  // namespace

MapFromScans::MapFromScans(const MappingParameters& parameters) : parameters_(parameters) {
  assert(parameters.resolution > 0.0 && parameters.max_range > 0.0);
}

Status MapFromScans::add(const PlacedScan& scan) {
  const geometry::Pose2& pose = scan.map_T_laser;
  if (!pose.finite() || !std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment) ||
      std::max(std::abs(pose.x), std::abs(pose.y)) > kFarthest) {
    return Error{"a scan for a map needs a finite pose within 1000 km and finite angles"};
  }
  const auto usable = [&](float range) {
    return std::isfinite(range) && range > 0.0F && range < parameters_.max_range;
  };
  const auto end_of = [&](std::size_t i) {
    const double angle = pose.yaw + scan.angle_min + static_cast<double>(i) * scan.angle_increment;
    const double range = scan.ranges[i];
    return geometry::Point2(pose.x + range * std::cos(angle), pose.y + range * std::sin(angle));
  };
  geometry::Point2 low = pose.position();
  geometry::Point2 high = low;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!usable(scan.ranges[i])) continue;
    low = low.cwiseMin(end_of(i));
    high = high.cwiseMax(end_of(i));
  }
  if (!make_room(low, high)) {
    return Error{"a scan would let the map grow beyond " + std::to_string(parameters_.max_cells) +
                 " cells"};
  }
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    if (!usable(scan.ranges[i])) continue;
    const geometry::Point2 end = end_of(i);
    grid::traverse(counts_.geometry(), pose.position(), end,
                   [&](grid::Cell cell) { return ++counts_.at(cell).passed, true; });
    Counts& last = counts_.at(counts_.geometry().cell_at(end));
    --last.passed;
    ++last.ended;
  }
  return {};
}

bool MapFromScans::make_room(const geometry::Point2& low, const geometry::Point2& high) {
  grid::GridGeometry now = counts_.geometry();
  if (counts_.empty()) {
    now = {0, 0, parameters_.resolution,
           std::floor(low.x() / parameters_.resolution) * parameters_.resolution,
           std::floor(low.y() / parameters_.resolution) * parameters_.resolution};
  }
  // One cell to spare on each side: the origin is rounded when the grid grows.
  const grid::Cell first = now.cell_at(low);
  const grid::Cell last = now.cell_at(high);
  const int left = first.x > 0 ? 0 : std::max(kGrowth, 1 - first.x);
  const int below = first.y > 0 ? 0 : std::max(kGrowth, 1 - first.y);
  const int right = last.x < now.width - 1 ? 0 : std::max(kGrowth, last.x + 2 - now.width);
  const int above = last.y < now.height - 1 ? 0 : std::max(kGrowth, last.y + 2 - now.height);
  if (left + below + right + above == 0) return true;
  const grid::GridGeometry larger{
      now.width + left + right, now.height + below + above, now.resolution,
      std::round(now.origin_x / now.resolution - left) * now.resolution,
      std::round(now.origin_y / now.resolution - below) * now.resolution};
  if (larger.size() > parameters_.max_cells) return false;
  grid::Grid<Counts> counts(larger);
  for (int y = 0; y < counts_.height(); ++y) {
    std::copy_n(counts_.row(y), counts_.width(), counts.row(y + below) + left);
  }
  counts_ = std::move(counts);
  return true;
}

grid::OccupancyGrid MapFromScans::map() const {
  grid::Cell low{counts_.width(), counts_.height()};
  grid::Cell high{-1, -1};
  for (int y = 0; y < counts_.height(); ++y) {
    for (int x = 0; x < counts_.width(); ++x) {
      const Counts& counts = counts_.at({x, y});
      if (counts.ended + counts.passed == 0) continue;
      low = {std::min(low.x, x), std::min(low.y, y)};
      high = {std::max(high.x, x), std::max(high.y, y)};
    }
  }
  if (high.x < 0) return {};
  const grid::GridGeometry& g = counts_.geometry();
  grid::OccupancyGrid map(
      {high.x - low.x + 3, high.y - low.y + 3, g.resolution,
       g.origin_x + (low.x - 1) * g.resolution, g.origin_y + (low.y - 1) * g.resolution},
      grid::kUnknown);
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      const Counts& counts = counts_.at({x, y});
      const double all = static_cast<double>(counts.ended) + counts.passed;
      if (all == 0.0) continue;
      const bool occupied = counts.ended > 0 && counts.ended >= parameters_.occupied_share * all;
      map.at({x - low.x + 1, y - low.y + 1}) = occupied ? grid::kOccupied : grid::kFree;
    }
  }
  return map;
}

}  // namespace usher::map_server
