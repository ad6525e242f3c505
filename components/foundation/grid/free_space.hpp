#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::grid {

using geometry::Point2;

/// Where the middle of the robot may be: a map whose obstacles are grown by a safe distance, so
/// that a point stands for the robot (fig. 2 of the meeting report). Cells that were never seen are
/// blocked but not grown; beyond the map everything is blocked.
class FreeSpace {
 public:
  /// Blocks every cell whose centre is at most `inflation` [m] from the centre of an occupied cell.
  /// Costs about four passes over the map; keeps its memory.
  void build(const OccupancyGrid& map, double inflation);

  bool empty() const { return room_.empty(); }
  const GridGeometry& geometry() const { return room_.geometry(); }
  bool free(Cell cell) const { return room_.value_or(cell, 0) != 0; }
  bool free(const Point2& point) const { return free(geometry().cell_at(point)); }
  /// A cell of the map by its index.
  bool free_at(std::size_t index) const { return room_[index] != 0; }
  /// Whether every cell that the segment crosses is free. Flies over what is known to be free: a
  /// line costs some ten steps, however long it is.
  bool line_free(const Point2& from, const Point2& to) const;
  /// The free point nearest to `point` among cell centres within `radius` [m]; the point itself
  /// when it is free.
  std::optional<Point2> nearest_free(const Point2& point, double radius) const;

 private:
  OccupancyGrid grown_;
  DistanceField field_;
  /// 0: blocked; k: free, and so is everything within k - 1 cells of each point of the cell.
  Grid<std::uint8_t> room_;
};

}  // namespace usher::grid
