#pragma once

#include <span>

#include "foundation/geometry/pose2.hpp"

namespace usher::costmap {

/// One planar scan for comparing two sensors.
struct ComparedScan {
  geometry::Pose2 sensor;         ///< in a frame that both scans share
  double angle_min = 0.0;         ///< [rad] of the first beam
  double angle_increment = 0.0;   ///< [rad] between beams
  std::span<const float> ranges;  ///< [m] REP 117
};

/// An ultrasonic echo comes from anywhere in a wide cone: put on the cone's axis, a wall that is
/// met at an angle seems to stand inside the corridor. What the laser sees in the cone at that
/// distance or nearer explains the echo, and the laser's own layer has it at its right place. What
/// remains is what ultrasonic sensors are for: glass, which the laser looks through.
///
/// Sets every range of `echoes` to NaN (nothing known) that `laser` explains within `half_cone`
/// [rad] and `tolerance` [m]. Without a laser scan nothing is explained. O(echoes x beams).
void drop_explained_echoes(const ComparedScan& laser, const ComparedScan& sonar, double half_cone,
                           double tolerance, std::span<float> echoes);

}  // namespace usher::costmap
