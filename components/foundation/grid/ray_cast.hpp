#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "foundation/grid/grid.hpp"

namespace usher::grid {

/// Where a ray ended.
struct RayHit {
  double range = 0.0;  ///< [m] from the ray's start to where it enters the blocking cell; 0 when it
                       ///< starts in one
  Cell cell;           ///< the blocking cell
};

/// The walk of a straight line over a grid, cell by cell, after [amanatides1987traversal]: every
/// cell that the line crosses, each once, each sharing an edge with the one before. Times are
/// distances along the line in cells, computed from the cell's own border and never accumulated, so
/// a long walk is as exact as a short one. A line through a corner steps in y first.
class CellWalk {
 public:
  /// Start and unit direction in cells (cell (0,0) spans [0,1) x [0,1)).
  CellWalk(double x, double y, double direction_x, double direction_y)
      : x_(x), y_(y), inverse_x_(1.0 / direction_x), inverse_y_(1.0 / direction_y) {
    side_x_ = direction_x > 0 ? 1 : 0;
    side_y_ = direction_y > 0 ? 1 : 0;
    moves_x_ = direction_x != 0;
    moves_y_ = direction_y != 0;
    enter({static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))}, 0.0);
  }

  Cell cell() const { return cell_; }
  /// Where the line entered the cell [cells from the start].
  double time() const { return time_; }

  /// Whether the next border is one between columns.
  bool crosses_column() const { return time_x_ < time_y_; }
  void step_x() {
    time_ = time_x_;
    cell_.x += 2 * side_x_ - 1;
    time_x_ = border_x();
  }
  void step_y() {
    time_ = time_y_;
    cell_.y += 2 * side_y_ - 1;
    time_y_ = border_y();
  }
  void step() { crosses_column() ? step_x() : step_y(); }

  /// Goes on from a later point of the line: `cell` must be the line's cell at `time`.
  void enter(Cell cell, double time) {
    cell_ = cell;
    time_ = time;
    time_x_ = border_x();
    time_y_ = border_y();
  }

 private:
  double border_x() const {
    return moves_x_ ? (cell_.x + side_x_ - x_) * inverse_x_
                    : std::numeric_limits<double>::infinity();
  }
  double border_y() const {
    return moves_y_ ? (cell_.y + side_y_ - y_) * inverse_y_
                    : std::numeric_limits<double>::infinity();
  }

  double x_, y_, inverse_x_, inverse_y_;
  int side_x_, side_y_;
  bool moves_x_, moves_y_;
  Cell cell_;
  double time_ = 0.0, time_x_ = 0.0, time_y_ = 0.0;
};

/// Visits every cell of the segment in order, the cells of both ends included: |dx| + |dy| + 1
/// cells for ends that are dx columns and dy rows apart. The cells may lie outside the grid.
/// `visit(Cell)` returns whether to go on. The points must be finite and their cells must fit an
/// int.
template <class Visit>
void traverse(const GridGeometry& geometry, const geometry::Point2& from,
              const geometry::Point2& to, Visit&& visit) {
  const Cell last = geometry.cell_at(to);
  const double dx = (to.x() - from.x()) / geometry.resolution;
  const double dy = (to.y() - from.y()) / geometry.resolution;
  CellWalk walk((from.x() - geometry.origin_x) / geometry.resolution,
                (from.y() - geometry.origin_y) / geometry.resolution, dx, dy);
  // The counts bound the walk and bring it to the last cell whatever rounding does to the order of
  // two borders.
  int left_x = std::abs(last.x - walk.cell().x);
  int left_y = std::abs(last.y - walk.cell().y);
  while (visit(walk.cell()) && left_x + left_y > 0) {
    if (left_y == 0 || (left_x > 0 && walk.crosses_column())) {
      walk.step_x();
      --left_x;
    } else {
      walk.step_y();
      --left_y;
    }
  }
}

namespace internal {

/// The part [enter, leave] of a line inside [0, size), or enter > leave.
inline void clip(double start, double direction, int size, double& enter, double& leave) {
  if (direction == 0.0) {
    if (start < 0.0 || start >= size) leave = -1.0;
    return;
  }
  const double a = (0.0 - start) / direction;
  const double b = (size - start) / direction;
  enter = std::max(enter, std::min(a, b));
  leave = std::min(leave, std::max(a, b));
}

}  // namespace internal

/// The first cell that blocks a ray, or nothing when it leaves the grid or `max_range` [m] comes
/// first. Cells outside the grid do not block, so a ray may start outside. `blocks(Cell)` is asked
/// for cells of the grid, in order; `skip(Cell)` returns how far [cells] the ray may fly on from
/// any point of that cell without asking (0: nothing known). Nothing for a start, direction or
/// range that is NaN or a range below 0; the range may be infinite.
template <class Blocks, class Skip>
std::optional<RayHit> cast_ray(const GridGeometry& geometry, const geometry::Point2& start,
                               double direction, double max_range, Blocks&& blocks, Skip&& skip) {
  const double x = (start.x() - geometry.origin_x) / geometry.resolution;
  const double y = (start.y() - geometry.origin_y) / geometry.resolution;
  const double dx = std::cos(direction);
  const double dy = std::sin(direction);
  if (!std::isfinite(x + y + dx + dy) || std::isnan(max_range)) return std::nullopt;
  double enter = 0.0;
  double leave = max_range / geometry.resolution;
  internal::clip(x, dx, geometry.width, enter, leave);
  internal::clip(y, dy, geometry.height, enter, leave);
  if (enter > leave) return std::nullopt;

  const auto cell_at = [&](double time) {
    return Cell{static_cast<int>(std::floor(x + dx * time)),
                static_cast<int>(std::floor(y + dy * time))};
  };
  CellWalk walk(x, y, dx, dy);
  if (enter > 0.0) {  // starts outside; rounding may put the entry one cell beside the border
    const Cell cell = cell_at(enter);
    walk.enter(
        {std::clamp(cell.x, 0, geometry.width - 1), std::clamp(cell.y, 0, geometry.height - 1)},
        enter);
  }
  while (geometry.contains(walk.cell()) && walk.time() <= leave) {
    if (blocks(walk.cell())) return RayHit{walk.time() * geometry.resolution, walk.cell()};
    const double free = skip(walk.cell());
    if (free > 2.0) {
      const double time = walk.time() + free;
      if (time > leave) return std::nullopt;
      walk.enter(cell_at(time), time);
    } else {
      walk.step();
    }
  }
  return std::nullopt;
}

/// The same without knowledge about free space.
template <class Blocks>
std::optional<RayHit> cast_ray(const GridGeometry& geometry, const geometry::Point2& start,
                               double direction, double max_range, Blocks&& blocks) {
  return cast_ray(geometry, start, direction, max_range, blocks, [](Cell) { return 0.0; });
}

}  // namespace usher::grid
