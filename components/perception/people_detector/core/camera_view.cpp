#include "perception/people_detector/core/camera_view.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/result/bounds.hpp"

namespace usher::people_detector {

PlacedCamera place_camera(const geometry::Pose3& base_T_optical) {
  Eigen::Matrix3d axes;  // of an optical frame that looks along x
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Matrix3d turned = base_T_optical.rotation.toRotationMatrix() * axes.transpose();
  const double yaw = std::atan2(turned(1, 0), turned(0, 0));
  return {{base_T_optical.translation.z(), std::asin(std::clamp(-turned(2, 0), -1.0, 1.0)),
           std::atan2(turned(2, 1), turned(2, 2))},
          {base_T_optical.translation.x(), base_T_optical.translation.y(), yaw}};
}

Status check(const SightingErrors& e) {
  return within({{"along", e.along, 0.01, 0.5, "m"},
                 {"along_growth", e.along_growth, 0.0, 0.2},
                 {"across", e.across, 0.01, 0.5, "m"},
                 {"across_growth", e.across_growth, 0.0, 0.2}});
}

void place_sightings(std::span<const Sighting> sightings, const geometry::Pose2& odom_T_foot,
                     const SightingErrors& errors, std::vector<Observation>& observations) {
  observations.clear();
  for (const Sighting& one : sightings) {
    const geometry::Point2 seen(one.forward, one.left);
    const double range = seen.norm();
    observations.push_back({odom_T_foot * seen,
                            covariance_along(odom_T_foot.yaw + std::atan2(one.left, one.forward),
                                             errors.along + errors.along_growth * range,
                                             errors.across + errors.across_growth * range),
                            one.height, one.appearance});
  }
}

}  // namespace usher::people_detector
