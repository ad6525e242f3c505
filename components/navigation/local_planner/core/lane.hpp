#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "navigation/local_planner/core/reference_path.hpp"
#include "navigation/local_planner/core/rollout.hpp"

namespace usher::local_planner {

/// Makes room for who comes the other way: while somebody does, the robot keeps to one side of its
/// path, the country's, as far as walls allow. A path through the middle of a corridor leaves room
/// on neither side.
class Lane {
 public:
  /// `half_width` [m] of the robot; `gap` [m] that it keeps from what stands on its side; `side` +1
  /// right, -1 left.
  Lane(double half_width, double gap, double side = 1.0)
      : half_width_(half_width), gap_(gap), side_(side) {}

  /// Looks for somebody who comes along the next metres of the path, and for the room there.
  void choose(const ReferencePath& path, const grid::Grid<std::uint8_t>& costs,
              std::span<const MovingDisc> discs, double seconds);
  void clear() { left_ = 0.0, shifts_.clear(); }

  bool keeps_aside() const { return !shifts_.empty(); }
  /// [m] to its side of the path at `arc`.
  double shift(double arc) const;
  /// The point of the lane beside the path's point at `arc`.
  geometry::Point2 point(const ReferencePath& path, double arc) const;

 private:
  double room(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& at) const;

  geometry::Point2 aside(double yaw) const;

  double half_width_, gap_, side_;
  double left_ = 0.0;   // [s] that it still keeps aside
  double start_ = 0.0;  // [m] along the path, of the first shift
  std::vector<double> rooms_, shifts_;
};

}  // namespace usher::local_planner
