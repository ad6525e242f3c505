#include "navigation/local_planner/core/trail.hpp"

#include <algorithm>
#include <cmath>

namespace usher::local_planner {
namespace {

constexpr double kStep = 0.05;        // [m] between two points
constexpr double kAhead = 0.4;        // [m] the point that is steered for is this far away
constexpr double kSteepest = 1.0;     // tangent of its bearing; beyond, it lies beside the robot
constexpr double kFastestTurn = 0.4;  // [rad/s]

}  // namespace

void Trail::add(const geometry::Pose2& pose) {
  const geometry::Point2 here = pose.position();
  if (size_ > 0 && (newest() - here).norm() < kStep) return;
  points_[(begin_ + size_) % kCapacity] = here;
  if (size_ < kCapacity) {
    ++size_;
  } else {
    begin_ = (begin_ + 1) % kCapacity;
  }
}

double Trail::turn_rate_back(const geometry::Pose2& pose, double speed) {
  while (size_ > 1 && (newest() - pose.position()).norm() < kAhead) --size_;
  if (size_ == 0) return 0.0;
  const geometry::Point2 target = geometry::inverse(pose) * newest();
  if (target.x() > 0.0 || std::abs(target.y()) > -kSteepest * target.x()) return 0.0;
  // The arc through the target: curvature 2 y / d^2, driven backward.
  const double rate = -speed * 2.0 * target.y() / target.squaredNorm();
  return std::clamp(rate, -kFastestTurn, kFastestTurn);
}

}  // namespace usher::local_planner
