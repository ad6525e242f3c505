#pragma once

#include <Eigen/Core>
#include <cmath>

#include "foundation/geometry/angle.hpp"

namespace usher::geometry {

using Point2 = Eigen::Vector2d;  ///< [m]

/// A planar pose, equally a planar rigid transform (SE(2)). Named by frames: `map_T_base *
/// point_in_base` is in map, and a pose `goal_in_map` is the transform map_T_goal.
struct Pose2 {
  double x = 0.0;    ///< [m]
  double y = 0.0;    ///< [m]
  double yaw = 0.0;  ///< [rad] counter-clockwise from +x

  Point2 position() const { return {x, y}; }
  bool finite() const { return std::isfinite(x) && std::isfinite(y) && std::isfinite(yaw); }
  bool operator==(const Pose2&) const = default;
};

/// a_T_c = a_T_b * b_T_c. The yaw of the result is normalized.
inline Pose2 operator*(const Pose2& a_T_b, const Pose2& b_T_c) {
  const double c = std::cos(a_T_b.yaw);
  const double s = std::sin(a_T_b.yaw);
  return {a_T_b.x + c * b_T_c.x - s * b_T_c.y, a_T_b.y + s * b_T_c.x + c * b_T_c.y,
          normalized(a_T_b.yaw + b_T_c.yaw)};
}

inline Point2 operator*(const Pose2& a_T_b, const Point2& point_in_b) {
  const double c = std::cos(a_T_b.yaw);
  const double s = std::sin(a_T_b.yaw);
  return {a_T_b.x + c * point_in_b.x() - s * point_in_b.y(),
          a_T_b.y + s * point_in_b.x() + c * point_in_b.y()};
}

/// b_T_a from a_T_b.
inline Pose2 inverse(const Pose2& a_T_b) {
  const double c = std::cos(a_T_b.yaw);
  const double s = std::sin(a_T_b.yaw);
  return {-c * a_T_b.x - s * a_T_b.y, s * a_T_b.x - c * a_T_b.y, normalized(-a_T_b.yaw)};
}

inline double distance(const Pose2& a, const Pose2& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Position and yaw interpolated linearly, the yaw along the shortest turn; fraction 0 gives `a`, 1
/// gives `b`, values outside extrapolate.
inline Pose2 interpolate(const Pose2& a, const Pose2& b, double fraction) {
  return {a.x + fraction * (b.x - a.x), a.y + fraction * (b.y - a.y),
          normalized(a.yaw + fraction * shortest_turn(a.yaw, b.yaw))};
}

/// Planar velocity in the body frame.
struct Twist2 {
  double v = 0.0;  ///< [m/s] forward
  double w = 0.0;  ///< [rad/s] counter-clockwise

  bool finite() const { return std::isfinite(v) && std::isfinite(w); }
  bool operator==(const Twist2&) const = default;
};

/// The pose reached from `pose` by a constant twist during `seconds` (exact arc).
inline Pose2 integrate(const Pose2& pose, const Twist2& twist, double seconds) {
  const double turn = twist.w * seconds;
  const double length = twist.v * seconds;
  // Chord of the arc: sinc keeps it exact through w = 0.
  const double half = 0.5 * turn;
  const double chord =
      std::abs(half) < 1e-6 ? length * (1.0 - half * half / 6.0) : length * std::sin(half) / half;
  return {pose.x + chord * std::cos(pose.yaw + half), pose.y + chord * std::sin(pose.yaw + half),
          normalized(pose.yaw + turn)};
}

}  // namespace usher::geometry
