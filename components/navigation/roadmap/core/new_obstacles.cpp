#include "navigation/roadmap/core/new_obstacles.hpp"

#include <algorithm>

#include "foundation/grid/costs.hpp"

namespace usher::roadmap {

void new_obstacles(const grid::Grid<std::uint8_t>& costs, const grid::DistanceField& map_distances,
                   const Point2& robot, double radius, double tolerance,
                   std::vector<Point2>& points) {
  points.clear();
  const grid::GridGeometry& g = costs.geometry();
  const Point2 reach = Point2::Constant(radius);
  const grid::Cell low = g.cell_at(Point2(robot - reach)), high = g.cell_at(Point2(robot + reach));
  for (int y = std::max(0, low.y); y <= std::min(g.height - 1, high.y); ++y) {
    for (int x = std::max(0, low.x); x <= std::min(g.width - 1, high.x); ++x) {
      if (costs.at({x, y}) != grid::kLethalCost) continue;
      const Point2 point = g.center({x, y});
      if ((point - robot).norm() > radius) continue;
      const grid::Cell cell = map_distances.geometry().cell_at(point);
      if (map_distances.geometry().contains(cell) && map_distances.distance(cell) > tolerance)
        points.push_back(point);
    }
  }
}

}  // namespace usher::roadmap
