#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

#include "foundation/geometry/pose2.hpp"

namespace usher::estimation {

struct PoseStatistics {
  double weight = 0.0;  ///< sum of all weights; with 0 the rest is zero
  geometry::Pose2 mean;
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< x, y [m], yaw [rad]: second central moments
};

/// Weighted mean and covariance of `count` planar poses. The mean yaw is the direction of the mean
/// unit vector; yaw deviations are shortest turns from it. Weights are at least 0 and need no norm.
/// `pose_at(i)` and `weight_at(i)` are called twice for each i, in order. Opposite directions of
/// equal weight have no mean direction: the result is then some direction with a large variance.
template <class PoseAt, class WeightAt>
PoseStatistics pose_statistics(std::size_t count, PoseAt&& pose_at, WeightAt&& weight_at) {
  PoseStatistics result;
  double x = 0.0, y = 0.0, c = 0.0, s = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::Pose2 pose = pose_at(i);
    const double weight = weight_at(i);
    result.weight += weight;
    x += weight * pose.x;
    y += weight * pose.y;
    c += weight * std::cos(pose.yaw);
    s += weight * std::sin(pose.yaw);
  }
  if (!(result.weight > 0.0)) return {};
  result.mean = {x / result.weight, y / result.weight, std::atan2(s, c)};
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::Pose2 pose = pose_at(i);
    const Eigen::Vector3d deviation(pose.x - result.mean.x, pose.y - result.mean.y,
                                    geometry::shortest_turn(result.mean.yaw, pose.yaw));
    result.covariance += weight_at(i) * deviation * deviation.transpose();
  }
  result.covariance /= result.weight;
  return result;
}

}  // namespace usher::estimation
