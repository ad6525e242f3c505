#pragma once

#include <array>
#include <cstddef>

#include "foundation/geometry/pose2.hpp"

namespace usher::local_planner {

/// The way that the robot came, for backing off along it: where it has just been there was room.
/// Remembers the last 3.2 m.
class Trail {
 public:
  /// Where the robot is now, in a frame that does not jump (odom).
  void add(const geometry::Pose2& pose);
  void clear() { size_ = 0; }

  /// The turn rate [rad/s] that steers the robot, driving backward at `speed` [m/s, positive],
  /// towards its trail (pure pursuit). What lies beside the robot or was passed is forgotten; zero
  /// where no trail is left behind it.
  double turn_rate_back(const geometry::Pose2& pose, double speed);

 private:
  static constexpr std::size_t kCapacity = 64;

  const geometry::Point2& newest() const { return points_[(begin_ + size_ - 1) % kCapacity]; }

  std::array<geometry::Point2, kCapacity> points_;
  std::size_t begin_ = 0, size_ = 0;
};

}  // namespace usher::local_planner
