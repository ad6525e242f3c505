#include "navigation/costmap/core/costs.hpp"

#include <cmath>

namespace usher::costmap {

std::uint8_t CostDecay::at(double distance) const {
  constexpr double kRounding = 1e-9;  // [m]
  if (distance <= 0.0) return kLethalCost;
  if (distance <= inscribed_radius + kRounding) return kInscribedCost;
  if (distance > inflation_radius + kRounding) return kFreeCost;
  return static_cast<std::uint8_t>(252.0 * std::exp(-cost_scaling * (distance - inscribed_radius)));
}

}  // namespace usher::costmap
