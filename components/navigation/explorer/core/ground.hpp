#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/grid/free_space.hpp"
#include "foundation/grid/wavefront.hpp"
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

  bool empty() const { return passing_.empty(); }
  /// Where a viewpoint may be.
  const grid::FreeSpace& standing() const { return standing_; }
  const grid::OccupancyGrid& standing_map() const { return standing_map_; }

  /// Measures all ways anew, from `robot`, or from the nearest place within 0.5 m where it can
  /// pass. False: there is none, and nothing is reachable.
  bool start_from(const Point2& robot);
  /// [m] of the way to a point, at most 8 % longer than the shortest; infinite when there is none.
  double way_to(const Point2& point) const;
  /// Middles of the cells of that way, from the robot to the point; empty when there is none.
  void trace(const Point2& point, std::vector<Point2>& way) const;

 private:
  std::uint16_t length_at(grid::Cell cell) const;

  grid::FreeSpace passing_, standing_;
  grid::OccupancyGrid standing_map_;
  grid::Wavefront wavefront_;
  std::vector<std::uint16_t> lengths_;  // from the robot; empty: nothing is reachable
};

}  // namespace usher::explorer
