#pragma once

#include "foundation/geometry/pose2.hpp"
#include "foundation/random/random.hpp"
#include "localization/amcl/core/particles.hpp"

namespace usher::amcl {

/// Noise of wheel odometry [thrun2005, table 5.6]: the variance of each part of a step is the sum
/// of alpha times the square of its cause.
struct MotionNoise {
  double alpha1 = 0.1;  ///< [rad^2/rad^2] rotation from rotation
  double alpha2 = 0.1;  ///< [rad^2/m^2] rotation from translation
  double alpha3 = 0.1;  ///< [m^2/m^2] translation from translation
  double alpha4 = 0.1;  ///< [m^2/rad^2] translation from rotation

  bool operator==(const MotionNoise&) const = default;
};

/// Moves every particle by the odometry's step `base0_T_base1` with noise drawn for each: rotation,
/// translation, rotation [thrun2005, table 5.6]. A step too short to have a direction (under 0.01
/// m) is a turn in place; driving backwards counts as a small rotation, not as half a turn.
void move(Particles& particles, const geometry::Pose2& base0_T_base1, const MotionNoise& noise,
          Random& random);

}  // namespace usher::amcl
