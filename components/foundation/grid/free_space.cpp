#include "foundation/grid/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "foundation/grid/ray_cast.hpp"

namespace usher::grid {

namespace {

constexpr int kFlight = 24;               // [cells] how far a line may fly at most
constexpr std::uint8_t kWorthFlying = 4;  // below, walking from cell to cell is cheaper

/// From any point of a cell to any point of a cell whose centre is `apart` cells away: at least
/// apart - sqrt 2. So everything within this many cells of a free cell's points is free.
std::vector<std::uint8_t> flights() {
  std::vector<std::uint8_t> table(kFlight * kFlight + 1);
  for (std::size_t squared = 1; squared < table.size(); ++squared)
    table[squared] = static_cast<std::uint8_t>(
        1 + std::max(0.0, std::floor(std::sqrt(static_cast<double>(squared)) - 1.41422)));
  return table;
}

}  // namespace

void FreeSpace::build(const OccupancyGrid& map, double inflation) {
  static const std::vector<std::uint8_t> kFlights = flights();
  const double cells = inflation / map.resolution();
  field_.build(map, (std::floor(cells + 1e-9) + 1.5) * map.resolution());
  const auto reach = static_cast<std::uint16_t>(std::floor(cells * cells + 1e-6));
  grown_ = map;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const bool blocked = map[i] < 0 || field_.squared_cells()[i] <= reach;
    grown_[i] = blocked ? kOccupied : kFree;
  }
  field_.build(grown_, (kFlight + 0.5) * map.resolution());
  if (room_.geometry() != map.geometry()) room_ = Grid<std::uint8_t>(map.geometry());
  for (std::size_t i = 0; i < map.size(); ++i) room_[i] = kFlights[field_.squared_cells()[i]];
}

bool FreeSpace::line_free(const Point2& from, const Point2& to) const {
  const GridGeometry& g = geometry();
  const double x = (from.x() - g.origin_x) / g.resolution;
  const double y = (from.y() - g.origin_y) / g.resolution;
  double dx = (to.x() - from.x()) / g.resolution;
  double dy = (to.y() - from.y()) / g.resolution;
  const double length = std::sqrt(dx * dx + dy * dy);
  if (!(length < std::numeric_limits<int>::max())) return false;
  if (length == 0.0) return free(from);
  if (!free(to)) return false;
  // Grown obstacles are thick: a look at the middle and the quarters turns most blocked lines down.
  for (const double share : {0.5, 0.25, 0.75}) {
    const Cell cell{static_cast<int>(std::floor(x + share * dx)),
                    static_cast<int>(std::floor(y + share * dy))};
    if (room_.value_or(cell, 0) == 0) return false;
  }
  dx /= length;
  dy /= length;
  CellWalk walk(x, y, dx, dy);
  while (walk.time() <= length) {
    const std::uint8_t room = room_.value_or(walk.cell(), 0);
    if (room == 0) return false;
    if (room < kWorthFlying) {
      walk.step();
      continue;
    }
    const double time = walk.time() + (room - 1);
    if (time >= length) return true;
    walk.enter(
        {static_cast<int>(std::floor(x + dx * time)), static_cast<int>(std::floor(y + dy * time))},
        time);
  }
  return true;
}

std::optional<Point2> FreeSpace::nearest_free(const Point2& point, double radius) const {
  if (free(point)) return point;
  const GridGeometry& g = geometry();
  const Cell center = g.cell_at(point);
  const int reach = static_cast<int>(std::ceil(radius / g.resolution));
  std::optional<Point2> best;
  double best_distance = radius;
  for (int y = center.y - reach; y <= center.y + reach; ++y) {
    for (int x = center.x - reach; x <= center.x + reach; ++x) {
      if (!free(Cell{x, y})) continue;
      const Point2 candidate = g.center({x, y});
      const double distance = (candidate - point).norm();
      if (distance <= best_distance && (!best || distance < best_distance)) {
        best = candidate;
        best_distance = distance;
      }
    }
  }
  return best;
}

}  // namespace usher::grid
