#include "foundation/grid/way_lengths.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "foundation/grid/costs.hpp"

namespace usher::grid {

namespace {

constexpr double kEscape = 0.5;                          // [m] to a place where the robot can pass
constexpr std::int8_t kOccupiedFrom = 65;                // percent, as map_server's default
constexpr int kMostCells = 2 * Wavefront::kLargestSide;  // a side

/// `factor` x `factor` cells in one: the most occupied of them; else unknown when one is.
OccupancyGrid coarser(const OccupancyGrid& map, int factor) {
  if (factor == 1) return map;
  GridGeometry geometry = map.geometry();
  geometry.width = (map.width() + factor - 1) / factor;
  geometry.height = (map.height() + factor - 1) / factor;
  geometry.resolution *= factor;
  OccupancyGrid coarse(geometry, kFree);
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      auto& cell = coarse.at({x / factor, y / factor});
      const auto value = map.at({x, y});
      const bool worse = value >= kOccupiedFrom ? value > cell : value < 0 && cell < kOccupiedFrom;
      if (worse) cell = value;
    }
  }
  return coarse;
}

}  // namespace

Status WayLengths::set_map(const OccupancyGrid& map, double room) {
  if (map.empty() || !(map.resolution() > 0.0)) return Error{"the map is empty"};
  const int side = std::max(map.width(), map.height());
  if (side > kMostCells)
    return Error{"the map may have " + std::to_string(kMostCells) + " cells a side, it has " +
                 std::to_string(side)};
  OccupancyGrid obstacles = coarser(map, (side - 1) / Wavefront::kLargestSide + 1);
  for (auto& value : obstacles) value = value >= kOccupiedFrom ? kOccupied : value;
  passing_.build(obstacles, room);
  Grid<std::uint8_t> costs(obstacles.geometry(), 0);
  for (std::size_t i = 0; i < costs.size(); ++i) costs[i] = passing_.free_at(i) ? 0 : kLethalCost;
  wavefront_.set_obstacles(costs, kLethalCost, true);
  lengths_.clear();
  return {};
}

bool WayLengths::start_from(const Point2& start) {
  lengths_.clear();
  if (empty() || !start.allFinite() || !(start.cwiseAbs().maxCoeff() < 1e6)) return false;
  const auto free = passing_.nearest_free(start, kEscape);
  if (!free) return false;
  wavefront_.spread(passing_.geometry().cell_at(*free), lengths_);
  return true;
}

std::uint16_t WayLengths::length_at(Cell cell) const {
  const GridGeometry& g = passing_.geometry();
  return lengths_.empty() || !g.contains(cell) ? Wavefront::kUnreachable : lengths_[g.index(cell)];
}

double WayLengths::way_to(const Point2& point) const {
  const bool sane = point.allFinite() && point.cwiseAbs().maxCoeff() < 1e6;
  const std::uint16_t length =
      sane ? length_at(passing_.geometry().cell_at(point)) : Wavefront::kUnreachable;
  if (length >= Wavefront::kUnreachable) return std::numeric_limits<double>::infinity();
  return length * passing_.geometry().resolution / Wavefront::kUnitsPerCell;
}

void WayLengths::trace(const Point2& point, std::vector<Point2>& way) const {
  way.clear();
  const GridGeometry& g = passing_.geometry();
  Cell cell = g.cell_at(point);
  std::uint16_t length = length_at(cell);
  if (length >= Wavefront::kUnreachable) return;
  way.push_back(g.center(cell));
  while (length > 0) {
    Cell next = cell;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell neighbor{cell.x + dx, cell.y + dy};
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

}  // namespace usher::grid
