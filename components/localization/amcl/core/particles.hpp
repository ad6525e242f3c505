#pragma once

#include <cstddef>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::amcl {

/// Pose hypotheses as a structure of arrays. Double, since poses are sums of many small steps at
/// coordinates of hundreds of metres; the sensor models round them once per update, relative to the
/// map's corner, to float.
struct Particles {
  std::vector<double> x, y;    ///< [m] in map
  std::vector<double> yaw;     ///< [rad] in [-pi, pi]
  std::vector<double> weight;  ///< at least 0

  std::size_t size() const { return x.size(); }
  geometry::Pose2 pose(std::size_t i) const { return {x[i], y[i], yaw[i]}; }
  void set(std::size_t i, const geometry::Pose2& pose, double w) {
    x[i] = pose.x, y[i] = pose.y, yaw[i] = pose.yaw, weight[i] = w;
  }
  void reserve(std::size_t count) {
    x.reserve(count), y.reserve(count), yaw.reserve(count), weight.reserve(count);
  }
  void resize(std::size_t count) {
    x.resize(count), y.resize(count), yaw.resize(count), weight.resize(count);
  }
};

}  // namespace usher::amcl
