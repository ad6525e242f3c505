// Turning a map whose origin has a yaw, so that every other part may take grids as axis-aligned.
#include <algorithm>
#include <cmath>

#include "foundation/grid/map_file.hpp"
#include "foundation/grid/ray_cast.hpp"

namespace usher::grid {
namespace {

/// The smallest axis-aligned grid that holds the turned one.
Result<GridGeometry> bounding_geometry(const GridGeometry& source, const geometry::Pose2& origin,
                                       std::size_t max_cells) {
  const double width = source.width * source.resolution;
  const double height = source.height * source.resolution;
  geometry::Point2 low = origin.position();
  geometry::Point2 high = low;
  for (const geometry::Point2& corner :
       {geometry::Point2{width, 0}, {0, height}, {width, height}}) {
    low = low.cwiseMin(origin * corner);
    high = high.cwiseMax(origin * corner);
  }
  // A quarter turn must not gain a row by rounding.
  const geometry::Point2 cells = ((high - low) / source.resolution).array() - 1e-6;
  const double columns = std::max(1.0, std::ceil(cells.x()));
  const double rows = std::max(1.0, std::ceil(cells.y()));
  if (columns * rows > static_cast<double>(max_cells)) {
    return Error{"expected at most " + std::to_string(max_cells) +
                 " cells after turning upright, found " + std::to_string(columns * rows)};
  }
  return GridGeometry{static_cast<int>(columns), static_cast<int>(rows), source.resolution, low.x(),
                      low.y()};
}

}  // namespace

Result<OccupancyGrid> turned_upright(const OccupancyGrid& grid, const geometry::Pose2& origin,
                                     std::size_t max_cells) {
  GridGeometry source = grid.geometry();
  source.origin_x = source.origin_y = 0.0;
  const auto target = bounding_geometry(source, origin, max_cells);
  if (!target) return Error{target.error()};
  OccupancyGrid upright(*target, kUnknown);
  const geometry::Pose2 source_T_map = inverse(origin);
  for (int y = 0; y < target->height; ++y) {
    for (int x = 0; x < target->width; ++x) {
      upright.at({x, y}) =
          grid.value_or(source.cell_at(source_T_map * target->center({x, y})), kUnknown);
    }
  }
  if (std::abs(std::sin(2.0 * origin.yaw)) < 1e-9)
    return upright;  // quarter turns: every centre met its cell
  // Half of the eight neighbours; the others draw towards this cell.
  constexpr std::array<Cell, 4> kForward = {Cell{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
  for (int y = 0; y < source.height; ++y) {
    for (int x = 0; x < source.width; ++x) {
      const std::int8_t value = grid.at({x, y});
      if (value <= kFree) continue;
      const geometry::Point2 center = origin * source.center({x, y});
      const auto raise = [&](Cell cell, std::int8_t to) {
        if (target->contains(cell)) upright.at(cell) = std::max(upright.at(cell), to);
      };
      raise(target->cell_at(center), value);
      for (const Cell step : kForward) {
        const Cell neighbour{x + step.x, y + step.y};
        const std::int8_t both = std::min(value, grid.value_or(neighbour, kUnknown));
        if (both <= kFree) continue;
        traverse(*target, center, origin * source.center(neighbour),
                 [&](Cell cell) { return raise(cell, both), true; });
      }
    }
  }
  return upright;
}

}  // namespace usher::grid
