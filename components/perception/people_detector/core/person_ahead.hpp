#pragma once

#include <optional>
#include <span>

#include "foundation/geometry/pose2.hpp"
#include "perception/people_detector/core/tracker.hpp"

namespace usher::people_detector {

/// What counts as the robot's way: a band along the arc that it drives, straight on while it
/// stands.
struct AheadConfig {
  double half_width = 0.33;  ///< [m] {0.1..1} of the robot
  double beside = 0.3;       ///< [m] {0..2} on both sides of it
  double reach = 3.0;        ///< [m] {0.5..8} along the arc, from the axle
  double soon = 1.0;         ///< [s] {0..3} who will be in the way by then is in it
  double unseen = 0.5;       ///< [s] {0.1..5} who was not seen for longer is nowhere
};

/// Somebody in the way or close beside the robot, seen from base_footprint.
struct PersonInTheWay {
  double distance = 0.0;       ///< [m] from the axle's middle
  double bearing = 0.0;        ///< [rad] positive left
  double closing_speed = 0.0;  ///< [m/s] positive: walks toward the robot
};

/// The nearest of `people` (states for the time `now` [s]) who is in the way; nothing: nobody is. A
/// pose or a twist that is not finite is an error of the caller.
std::optional<PersonInTheWay> person_ahead(std::span<const Track> people, double now,
                                           const geometry::Pose2& odom_T_base,
                                           const geometry::Twist2& twist,
                                           const AheadConfig& config);

}  // namespace usher::people_detector
