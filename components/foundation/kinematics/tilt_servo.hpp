#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/angle.hpp"

namespace usher::kinematics {

/// The servo that tilts the Kinect: equation 4.1 with the constants of the calibration: T = gain *
/// angle + offset.
struct TiltServo {
  static constexpr double kLimit = geometry::radians(20.0);  ///< [rad] of angle and servo

  static constexpr double kLeastGain = 0.5, kMostGain = 2.0;
  static constexpr double kMostOffset = 0.3;  ///< [rad]

  double gain = 1.0;    ///< [-] {kLeastGain..kMostGain}
  double offset = 0.0;  ///< [rad] {-kMostOffset..kMostOffset}

  /// What the servo must be set to for an angle of the camera on the body (positive up), both
  /// clipped to the limit.
  double servo_for(double angle) const {
    return std::clamp(gain * std::clamp(angle, -kLimit, kLimit) + offset, -kLimit, kLimit);
  }
  /// The camera's angle when the servo stands at a value.
  double angle_of(double servo) const { return (servo - offset) / gain; }
};

}  // namespace usher::kinematics
