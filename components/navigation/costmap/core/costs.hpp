#pragma once

#include <array>
#include <cstdint>

#include "foundation/grid/costs.hpp"

namespace usher::costmap {

/// The cost scale of the master grid, byte for byte that of ROS costmap_2d, so that rviz and every
/// planner written for it read ours. The robot is a point (the origin of its footprint) in a cell
/// of this cost:
///
///     255       unknown    no layer knows the cell, no obstacle within the inscribed radius
///     254       lethal     an obstacle is in the cell
///     253       inscribed  an obstacle within the inscribed radius: contact at every heading
///     252 .. 1  near       contact at some headings: what the footprint touches decides;
///                          trunc(252 exp(-cost_scaling (d - inscribed_radius))), where d is the
///                          distance to the nearest lethal cell, centre to centre
///     0         free       no obstacle within the inflation radius
///
/// The MARVIN thesis (5.2.4) reads the same byte in bands: 254 lethal, 253..128 "inscribed", 127..1
/// "possibly circumscribed", 0 free, unknown as free until seen. Its "inscribed" band is our 253
/// and the upper half of our decay: d up to inscribed_radius + ln(252 / 128) / cost_scaling. A
/// reader with the thesis' threshold 128 is therefore only more careful, never less.
using grid::kFreeCost;
using grid::kInscribedCost;
using grid::kLethalCost;
using grid::kUnknownCost;

/// How costs fall with the distance to the nearest obstacle. All lengths in m.
struct CostDecay {
  double inscribed_radius = 0.0;
  double inflation_radius = 0.55;  ///< no cost beyond it; at least the inscribed radius
  double cost_scaling = 10.0;      ///< [1/m] not negative

  /// The cost at a distance [m] from the nearest lethal cell; a nanometer of rounding is forgiven
  /// at both radii.
  std::uint8_t at(double distance) const;
};

/// Occupancy of a cost as nav_msgs/OccupancyGrid and rviz expect it: unknown -1, free 0,
/// near 1..98, inscribed 99, lethal 100.
constexpr std::array<std::int8_t, 256> make_occupancy_of_cost() {
  std::array<std::int8_t, 256> table{};
  for (int cost = 1; cost <= 252; ++cost) {
    table[static_cast<std::size_t>(cost)] = static_cast<std::int8_t>(1 + 97 * (cost - 1) / 251);
  }
  table[kInscribedCost] = 99;
  table[kLethalCost] = 100;
  table[kUnknownCost] = -1;
  return table;
}
inline constexpr std::array<std::int8_t, 256> kOccupancyOfCost = make_occupancy_of_cost();

}  // namespace usher::costmap
