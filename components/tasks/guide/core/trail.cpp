#include "tasks/guide/core/trail.hpp"

#include <cmath>

namespace usher::guide {

namespace {

constexpr double kStep = 0.15;      ///< [m]
constexpr double kLoop = 1.2;       ///< [m] of way that ends where it began
constexpr double kCrosses = 0.5;    ///< [m] within this
constexpr std::size_t kMost = 134;  ///< 20 m of such steps

}  // namespace

void Trail::see(const geometry::Point2& visitor) {
  if (!points_.empty() && (visitor - points_.back()).norm() < kStep) return;
  double length = points_.empty() ? 0.0 : (visitor - points_.back()).norm();
  for (std::size_t i = points_.size(); i >= 2; --i) {
    length += (points_[i - 1] - points_[i - 2]).norm();
    if (length < kLoop || (points_[i - 2] - visitor).norm() > kCrosses) continue;
    points_.resize(i - 1);
  }
  points_.push_back(visitor);
  if (points_.size() > kMost) points_.pop_front();
}

std::optional<geometry::Pose2> Trail::behind(double distance) const {
  for (std::size_t i = points_.size(); i >= 2; --i) {
    const geometry::Point2 step = points_[i - 1] - points_[i - 2];
    const double length = step.norm();
    if (distance <= length) {
      const geometry::Point2 place = points_[i - 1] - step * (distance / length);
      return geometry::Pose2{place.x(), place.y(), std::atan2(step.y(), step.x())};
    }
    distance -= length;
  }
  return std::nullopt;
}

}  // namespace usher::guide
