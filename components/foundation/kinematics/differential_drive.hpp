#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/pose2.hpp"

namespace usher::kinematics {

/// Ground speeds of the two driven wheels.
struct WheelSpeeds {
  double left = 0.0;   ///< [m/s] at the rim, positive forward
  double right = 0.0;  ///< [m/s]
  bool operator==(const WheelSpeeds&) const = default;
};

/// A base with two wheels on one axle; the body frame has its origin at the axle's middle, +x
/// forward, +y left. `track` is the distance between the wheels' contact points [m], positive.
struct DifferentialDrive {
  double track = 0.0;

  /// Body velocity from wheel speeds.
  geometry::Twist2 forward(const WheelSpeeds& wheels) const {
    return {0.5 * (wheels.left + wheels.right), (wheels.right - wheels.left) / track};
  }

  /// Wheel speeds that give a body velocity.
  WheelSpeeds inverse(const geometry::Twist2& twist) const {
    const double half = 0.5 * track * twist.w;
    return {twist.v - half, twist.v + half};
  }

  /// The twist closest to `twist` along its own curvature whose wheels stay within
  /// `max_wheel_speed` [m/s]: the arc is kept, the speed is given up.
  geometry::Twist2 limited(const geometry::Twist2& twist, double max_wheel_speed) const {
    const WheelSpeeds wheels = inverse(twist);
    const double fastest = std::max(std::abs(wheels.left), std::abs(wheels.right));
    if (fastest <= max_wheel_speed) return twist;
    const double scale = max_wheel_speed / fastest;
    return {twist.v * scale, twist.w * scale};
  }

  /// The pose after the wheels rolled `left` and `right` metres at constant speeds (exact arc).
  geometry::Pose2 rolled(const geometry::Pose2& pose, double left, double right) const {
    return geometry::integrate(pose, forward({left, right}), 1.0);
  }
};

}  // namespace usher::kinematics
