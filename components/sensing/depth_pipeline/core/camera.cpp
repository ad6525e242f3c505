#include "sensing/depth_pipeline/core/camera.hpp"

#include <cmath>

namespace usher::depth_pipeline {

CameraPose camera_pose(const Mount& mount, double angle, double pitch) {
  const double radius = std::hypot(mount.x, mount.z);
  const double lean = std::atan2(mount.x, mount.z) + pitch;
  CameraPose pose;
  pose.height = std::cos(lean) * radius + mount.axle;
  pose.forward = std::sin(lean) * radius;
  pose.down = pitch - angle;
  if (mount.backward) {
    pose.forward = -pose.forward;
    pose.down = -pitch - angle;
  }
  return pose;
}

}  // namespace usher::depth_pipeline
