#pragma once

#include <vector>

#include "foundation/grid/free_space.hpp"

namespace usher::roadmap {

using geometry::Point2;

/// What a costmap saw that the map does not have: middles of its lethal cells (254) within `radius`
/// [m] of `robot` that are farther than `tolerance` [m] from everything in the map. `map_distances`
/// measures to the map's occupied cells; both grids are in the frame of the map. Farther obstacles
/// are forgotten: 4 m in the meeting report. `points` is replaced.
void new_obstacles(const grid::Grid<std::uint8_t>& costs, const grid::DistanceField& map_distances,
                   const Point2& robot, double radius, double tolerance,
                   std::vector<Point2>& points);

}  // namespace usher::roadmap
