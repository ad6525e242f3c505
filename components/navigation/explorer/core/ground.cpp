#include "navigation/explorer/core/ground.hpp"

#include <algorithm>
#include <limits>
#include <string>

namespace usher::explorer {

namespace {

using grid::Wavefront;

constexpr double kEscape = 0.5;            // [m] to a place where the robot can pass
constexpr std::int8_t kOccupiedFrom = 65;  // percent, as map_server's default
constexpr std::uint8_t kBlocked = 254;

}  // namespace

Status Ground::set_map(const grid::OccupancyGrid& map, std::span<const Rectangle> leave_out,
                       double passing_room, double standing_room) {
  if (map.empty() || !(map.resolution() > 0.0)) return Error{"the map is empty"};
  if (std::max(map.width(), map.height()) > Wavefront::kLargestSide)
    return Error{"the map may have " + std::to_string(Wavefront::kLargestSide) +
                 " cells a side, it has " + std::to_string(std::max(map.width(), map.height()))};
  const grid::GridGeometry& g = map.geometry();
  standing_map_ = map;
  for (auto& value : standing_map_) value = value >= kOccupiedFrom ? grid::kOccupied : value;
  passing_.build(standing_map_, passing_room);
  grid::Grid<std::uint8_t> costs(g, 0);
  for (std::size_t i = 0; i < map.size(); ++i) costs[i] = passing_.free_at(i) ? 0 : kBlocked;
  wavefront_.set_obstacles(costs, kBlocked, true);
  // What is left out is as good as never seen: blocked, without being an obstacle to keep from.
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (standing_map_[i] == grid::kOccupied) continue;
    const Point2 center = g.center(g.cell(i));
    if (std::any_of(leave_out.begin(), leave_out.end(),
                    [&](const Rectangle& r) { return r.contains(center); }))
      standing_map_[i] = grid::kUnknown;
  }
  standing_.build(standing_map_, standing_room);
  lengths_.clear();
  return {};
}

bool Ground::start_from(const Point2& robot) {
  lengths_.clear();
  if (empty() || !robot.allFinite() || !(robot.cwiseAbs().maxCoeff() < 1e6)) return false;
  const auto start = passing_.nearest_free(robot, kEscape);
  if (!start) return false;
  wavefront_.spread(passing_.geometry().cell_at(*start), lengths_);
  return true;
}

std::uint16_t Ground::length_at(grid::Cell cell) const {
  const grid::GridGeometry& g = passing_.geometry();
  return lengths_.empty() || !g.contains(cell) ? Wavefront::kUnreachable : lengths_[g.index(cell)];
}

double Ground::way_to(const Point2& point) const {
  const std::uint16_t length = length_at(passing_.geometry().cell_at(point));
  if (length >= Wavefront::kUnreachable) return std::numeric_limits<double>::infinity();
  return length * passing_.geometry().resolution / Wavefront::kUnitsPerCell;
}

void Ground::trace(const Point2& point, std::vector<Point2>& way) const {
  way.clear();
  const grid::GridGeometry& g = passing_.geometry();
  grid::Cell cell = g.cell_at(point);
  std::uint16_t length = length_at(cell);
  if (length >= Wavefront::kUnreachable) return;
  way.push_back(g.center(cell));
  while (length > 0) {
    grid::Cell next = cell;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const grid::Cell neighbor{cell.x + dx, cell.y + dy};
        const std::uint16_t there = length_at(neighbor);
        if (there >= length) continue;
        length = there;
        next = neighbor;
      }
    }
    if (next == cell) break;
    cell = next;
    way.push_back(g.center(cell));
  }
  std::reverse(way.begin(), way.end());
}

}  // namespace usher::explorer
