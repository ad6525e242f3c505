#pragma once

#include <cstdint>

namespace usher::grid {

/// Cost of a cell for a robot that is a point, byte for byte that of ROS costmap_2d: what
/// navigation exchanges. 252 .. 1 fall with the distance to the nearest obstacle
/// (navigation/costmap).
inline constexpr std::uint8_t kFreeCost = 0;
inline constexpr std::uint8_t kInscribedCost = 253;  ///< nearer than the inscribed radius: contact
inline constexpr std::uint8_t kLethalCost = 254;     ///< an obstacle is in the cell
inline constexpr std::uint8_t kUnknownCost = 255;    ///< nobody knows

}  // namespace usher::grid
