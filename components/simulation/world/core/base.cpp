#include "simulation/world/core/base.hpp"

#include <algorithm>
#include <cmath>

namespace usher::world {

void Base::count_wheels(const Encoders& encoders, double distance, double turned, Random& random) {
  const double forward = distance * encoders.distance_scale;
  const double turn = turned * encoders.turn_scale + encoders.curl * distance;
  const double left = forward - 0.5 * encoders.track * turn;
  const double right = forward + 0.5 * encoders.track * turn;
  readings_.left_velocity = left / kStep;
  readings_.right_velocity = right / kStep;
  readings_.left_travel += left + encoders.slip * std::sqrt(std::abs(left)) * random.gaussian();
  readings_.right_travel += right + encoders.slip * std::sqrt(std::abs(right)) * random.gaussian();
}

void Base::drain_battery(double hours) {
  const double use = 100.0 * kStep / (3600.0 * hours) * (1.0 + std::abs(truth_.twist.v));
  readings_.battery_percent = std::max(0.0, readings_.battery_percent - use);
}

}  // namespace usher::world
