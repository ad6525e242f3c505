#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/grid/free_space.hpp"
#include "foundation/grid/way_lengths.hpp"
#include "foundation/result/result.hpp"
#include "navigation/explorer/core/seen_area.hpp"

namespace usher::explorer {

/// Where the robot may drive and stand, and how far everything is from where it is now.
class Ground {
 public:
  /// `passing_room` [m] from obstacles is enough to drive through, `standing_room` [m] to turn. A
  /// viewpoint may not lie in what is left out; a way may lead through it. An error says that the
  /// map is too large, or empty.
  Status set_map(const grid::OccupancyGrid& map, std::span<const Rectangle> leave_out,
                 double passing_room, double standing_room);

  bool empty() const { return ways_.empty(); }
  /// Where a viewpoint may be.
  const grid::FreeSpace& standing() const { return standing_; }
  const grid::OccupancyGrid& standing_map() const { return standing_map_; }

  /// Measures all ways anew, from `robot`, or from the nearest place within 0.5 m where it can
  /// pass. False: there is none, and nothing is reachable.
  bool start_from(const Point2& robot) { return ways_.start_from(robot); }
  /// [m] of the way to a point, at most 8 % longer than the shortest; infinite when there is none.
  double way_to(const Point2& point) const { return ways_.way_to(point); }
  /// Middles of the cells of that way, from the robot to the point; empty when there is none.
  void trace(const Point2& point, std::vector<Point2>& way) const { ways_.trace(point, way); }

 private:
  grid::WayLengths ways_;
  grid::FreeSpace standing_;
  grid::OccupancyGrid standing_map_;
};

}  // namespace usher::explorer
