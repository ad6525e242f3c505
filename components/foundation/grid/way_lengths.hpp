#pragma once

#include <cstdint>
#include <vector>

#include "foundation/grid/free_space.hpp"
#include "foundation/grid/wavefront.hpp"
#include "foundation/result/result.hpp"

namespace usher::grid {

/// How far everything is from one place, along ways on which the robot has room.
class WayLengths {
 public:
  /// Takes a map (occupied: from 65 % on); `room` [m] from obstacles is enough to drive through.
  /// A map of more than 2000 cells a side is measured on cells twice as large: a passage must be up
  /// to one of its own cells wider there. An error says that it has more than 4000, or none, and
  /// leaves what was there.
  Status set_map(const OccupancyGrid& map, double room);

  bool empty() const { return passing_.empty(); }
  const FreeSpace& passing() const { return passing_; }

  /// Measures all ways anew, from `start`, or from the nearest place within 0.5 m where the robot
  /// can pass. False: there is none, and nothing is reachable.
  bool start_from(const Point2& start);
  /// [m] of the way to a point, at most 8 % longer than the shortest, and two cells; infinite when
  /// there is none.
  double way_to(const Point2& point) const;
  /// Middles of the cells of that way, from the start to the point; empty when there is none.
  void trace(const Point2& point, std::vector<Point2>& way) const;

 private:
  std::uint16_t length_at(Cell cell) const;

  FreeSpace passing_;
  Wavefront wavefront_;
  std::vector<std::uint16_t> lengths_;  // from the start; empty: nothing is reachable
};

}  // namespace usher::grid
