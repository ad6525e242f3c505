#include "perception/face_detector/core/place.hpp"

#include <cmath>

namespace usher::face_detector {

Place place_of(const Box& box, double depth, const imaging::Intrinsics& intrinsics,
               const geometry::Pose3& base_T_camera) {
  // The middle of a box that begins at pixel 0 and has one pixel lies at column 0.
  const Eigen::Vector3d in_camera((box.column() - 0.5 - intrinsics.cx) / intrinsics.fx * depth,
                                  (box.row() - 0.5 - intrinsics.cy) / intrinsics.fy * depth, depth);
  const Eigen::Vector3d in_base = base_T_camera * in_camera;
  return {std::hypot(in_base.x(), in_base.y()), std::atan2(in_base.y(), in_base.x()), in_base.z()};
}

geometry::Pose3 fixed_camera(double forward, double height, double up) {
  Eigen::Matrix3d axes;  // optical: x right, y down, z forward
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {{forward, 0.0, height},
          geometry::from_roll_pitch_yaw(0.0, -up, 0.0) * Eigen::Quaterniond(axes)};
}

}  // namespace usher::face_detector
