#pragma once

#include <Eigen/Geometry>

#include "foundation/geometry/pose2.hpp"

namespace usher::geometry {

/// A rigid transform in space (SE(3)), read like Pose2: `base_T_laser * point_in_laser` is in base.
struct Pose3 {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< unit length

  bool finite() const { return translation.allFinite() && rotation.coeffs().allFinite(); }
};

inline Pose3 operator*(const Pose3& a_T_b, const Pose3& b_T_c) {
  return {a_T_b.translation + a_T_b.rotation * b_T_c.translation,
          (a_T_b.rotation * b_T_c.rotation).normalized()};
}
inline Eigen::Vector3d operator*(const Pose3& a_T_b, const Eigen::Vector3d& point_in_b) {
  return a_T_b.translation + a_T_b.rotation * point_in_b;
}
inline Pose3 inverse(const Pose3& a_T_b) {
  const Eigen::Quaterniond back = a_T_b.rotation.conjugate();
  return {-(back * a_T_b.translation), back};
}

/// Linear in position, along the great arc in rotation; a fraction outside [0, 1] extrapolates.
inline Pose3 interpolate(const Pose3& a, const Pose3& b, double fraction) {
  const Eigen::AngleAxisd turn(a.rotation.conjugate() * b.rotation);
  const double angle = turn.angle() > kPi ? turn.angle() - 2.0 * kPi : turn.angle();
  return {a.translation + fraction * (b.translation - a.translation),
          (a.rotation * Eigen::AngleAxisd(fraction * angle, turn.axis())).normalized()};
}

/// The same planar transform in space, at height 0.
inline Pose3 to_space(const Pose2& planar) {
  return {{planar.x, planar.y, 0.0},
          Eigen::Quaterniond(Eigen::AngleAxisd(planar.yaw, Eigen::Vector3d::UnitZ()))};
}

/// Rotation about +z of the projection to the plane: the direction of the x axis seen from above.
inline double yaw_of(const Eigen::Quaterniond& q) {
  return std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()),
                    1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
}

/// The projection to the plane: height and tilt are dropped.
inline Pose2 to_plane(const Pose3& pose) {
  return {pose.translation.x(), pose.translation.y(), yaw_of(pose.rotation)};
}

/// Rotation by roll, pitch, yaw about fixed x, y, z [rad]; positive pitch leans forward (x axis
/// down).
inline Eigen::Quaterniond from_roll_pitch_yaw(double roll, double pitch, double yaw) {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

}  // namespace usher::geometry
