#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::global_planner {

/// Visits every cell that the segment from `a` to `b` [cells; cell (x,y) covers x..x+1] passes
/// through or touches at a corner, in order: `visit(cell, length)` gets the length inside the cell
/// (0 for one that is only touched) and returns whether to go on. Returns whether all visits did.
/// Source: [amanatides1987traversal].
template <class Visit>
bool visit_line(const geometry::Point2& a, const geometry::Point2& b, Visit&& visit) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  constexpr double kCorner =
      1e-9;  // crossings closer than this (as part of the segment) are a corner
  grid::Cell cell{static_cast<int>(std::floor(a.x())), static_cast<int>(std::floor(a.y()))};
  int columns = static_cast<int>(std::floor(b.x())) - cell.x;
  int rows = static_cast<int>(std::floor(b.y())) - cell.y;
  const int step_x = columns < 0 ? -1 : 1;
  const int step_y = rows < 0 ? -1 : 1;
  columns = std::abs(columns);
  rows = std::abs(rows);
  const geometry::Point2 delta = b - a;
  const double length = delta.norm();
  const double gap_x = columns > 0 ? 1.0 / std::abs(delta.x()) : kNever;
  const double gap_y = rows > 0 ? 1.0 / std::abs(delta.y()) : kNever;
  double next_x = columns > 0 ? (step_x > 0 ? cell.x + 1 - a.x() : a.x() - cell.x) * gap_x : kNever;
  double next_y = rows > 0 ? (step_y > 0 ? cell.y + 1 - a.y() : a.y() - cell.y) * gap_y : kNever;
  double entered = 0.0;  // as part of the segment, like next_x and next_y
  while (columns > 0 || rows > 0) {
    const bool corner = columns > 0 && rows > 0 && std::abs(next_x - next_y) < kCorner;
    const bool cross_x = corner || next_x < next_y;
    const double leave = cross_x ? next_x : next_y;
    if (!visit(cell, (leave - entered) * length)) return false;
    entered = leave;
    if (corner && !(visit(grid::Cell{cell.x + step_x, cell.y}, 0.0) &&
                    visit(grid::Cell{cell.x, cell.y + step_y}, 0.0)))
      return false;
    if (cross_x) cell.x += step_x, next_x = --columns > 0 ? next_x + gap_x : kNever;
    if (corner || !cross_x) cell.y += step_y, next_y = --rows > 0 ? next_y + gap_y : kNever;
  }
  return visit(cell, (1.0 - entered) * length);
}

}  // namespace usher::global_planner
