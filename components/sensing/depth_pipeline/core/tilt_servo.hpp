#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/angle.hpp"

namespace usher::depth_pipeline {

/// Equation 4.1 with the constants of the calibration: T = gain * angle + offset.
struct TiltServo {
  static constexpr double kLimit = geometry::radians(20.0);  ///< [rad] of angle and servo

  double gain = 1.0;    ///< [-] {0.5..2}
  double offset = 0.0;  ///< [rad] {-0.3..0.3}

  /// What the servo must be set to for an angle of the camera on the body (positive up), both
  /// clipped to the limit.
  double servo_for(double angle) const {
    return std::clamp(gain * std::clamp(angle, -kLimit, kLimit) + offset, -kLimit, kLimit);
  }
  /// The camera's angle when the servo stands at a value.
  double angle_of(double servo) const { return (servo - offset) / gain; }
};

}  // namespace usher::depth_pipeline
