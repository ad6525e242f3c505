#include "perception/people_detector/core/camera_view.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/geometry/angle.hpp"

namespace usher::people_detector {

namespace {

constexpr double kHalfBody = 0.25, kHalfHead = 0.12;  // [m]
constexpr double kClose = 0.7;  // [m] one behind the other: height and clothes may be the other's

/// Whether the other one stands close before him.
bool is_close_behind(const Sighting& one, const Sighting& other) {
  const double range = std::hypot(one.forward, one.left);
  const double nearer = std::hypot(other.forward, other.left);
  if (!(nearer > 0.0 && nearer < range && range - nearer < kClose)) return false;
  const double apart = std::abs(geometry::shortest_turn(std::atan2(other.left, other.forward),
                                                        std::atan2(one.left, one.forward)));
  return apart < kHalfBody / nearer + kHalfHead / range;
}

}  // namespace

PlacedCamera place_camera(const geometry::Pose3& base_T_optical) {
  Eigen::Matrix3d axes;  // of an optical frame that looks along x
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d turned = base_T_optical.rotation.toRotationMatrix() * axes.transpose();
  const double yaw = std::atan2(turned(1, 0), turned(0, 0));
  return {{base_T_optical.translation.z(), std::asin(std::clamp(-turned(2, 0), -1.0, 1.0)),
           std::atan2(turned(2, 1), turned(2, 2))},
          {base_T_optical.translation.x(), base_T_optical.translation.y(), yaw}};
}

void place_sightings(std::span<const Sighting> sightings, const geometry::Pose2& odom_T_foot,
                     const SightingErrors& errors, std::vector<Observation>& observations) {
  observations.clear();
  for (const Sighting& one : sightings) {
    const geometry::Point2 seen(one.forward, one.left);
    const double range = seen.norm();
    const bool mixed = std::any_of(sightings.begin(), sightings.end(), [&](const Sighting& other) {
      return is_close_behind(one, other);
    });
    observations.push_back({odom_T_foot * seen,
                            covariance_along(odom_T_foot.yaw + std::atan2(one.left, one.forward),
                                             errors.along + errors.along_growth * range,
                                             errors.across + errors.across_growth * range),
                            mixed ? 0.0 : one.height,
                            mixed ? imaging::Appearance{} : one.appearance, one.head_hidden});
  }
}

}  // namespace usher::people_detector
