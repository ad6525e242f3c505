#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/pose2.hpp"

namespace usher::kinematics {

/// How fast a velocity command may change. All positive.
struct AccelerationLimits {
  double acceleration = 1.0;          ///< [m/s2] away from standstill
  double deceleration = 1.0;          ///< [m/s2] towards standstill
  double angular_acceleration = 2.0;  ///< [rad/s2] both ways
};

/// `from` moved towards `to` by at most `rise` where the magnitude grows and by at most `fall`
/// where it shrinks; a change of sign goes through zero and stops there.
inline double ramped(double from, double to, double rise, double fall) {
  if (from * to < 0.0) to = 0.0;
  const bool growing = std::abs(to) > std::abs(from);
  const double step = growing ? rise : fall;
  return std::clamp(to, from - step, from + step);
}

/// The command that follows `last` after `seconds` on the way to `target`. Not finite targets give
/// zero velocity as the target; negative or NaN `seconds` count as zero.
inline geometry::Twist2 limited(const geometry::Twist2& last, geometry::Twist2 target,
                                const AccelerationLimits& limits, double seconds) {
  if (!target.finite()) target = {};
  const double dt = seconds > 0.0 ? seconds : 0.0;
  const double turn = limits.angular_acceleration * dt;
  return {ramped(last.v, target.v, limits.acceleration * dt, limits.deceleration * dt),
          std::clamp(target.w, last.w - turn, last.w + turn)};
}

}  // namespace usher::kinematics
