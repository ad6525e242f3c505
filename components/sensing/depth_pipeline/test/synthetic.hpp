#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "foundation/random/random.hpp"
#include "sensing/depth_pipeline/core/camera.hpp"

namespace usher::depth_pipeline {

/// A box on the floor, in the frame of the camera's foot: x right, z forward.
struct SyntheticBox {
  double x0, x1, height, z0, z1;
};

/// Depth images of boxes on a floor between walls, straight from the definition.
struct SyntheticScene {
  Intrinsics camera{.cx = 256, .cy = 212};
  std::vector<SyntheticBox> boxes;
  double half_width = 2.5;  ///< [m] of the room
  double end = 5.0;         ///< [m] its far wall
  double ceiling = 10.0;    ///< [m]
  double noise = 0.0;       ///< [1/m] standard deviation over the square of the depth
  double dropouts = 0.0;    ///< share of pixels
  /// A hole in the floor: everything farther than this is `pit` m deeper.
  double edge = std::numeric_limits<double>::infinity();
  double pit = 1.0;

  std::vector<std::uint16_t> draw(const CameraPose& pose, std::uint64_t seed = 42) const {
    std::vector<std::uint16_t> image;
    Random random(seed);
    for (int row = 0; row < camera.height; ++row) {
      for (int column = 0; column < camera.width; ++column) {
        const double depth =
            at(pose, (column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy);
        const double noisy = depth + noise * depth * depth * random.gaussian();
        const bool lost = random.uniform() < dropouts;
        image.push_back(lost || noisy < 0.5 || noisy > 8.0
                            ? std::uint16_t{0}
                            : static_cast<std::uint16_t>(std::lround(noisy * 1e3)));
      }
    }
    return image;
  }

  /// Depth along the axis of the ray (x, y, 1).
  double at(const CameraPose& pose, double x, double y) const {
    const double level = x * std::cos(pose.roll) - y * std::sin(pose.roll);
    const double tilted = y * std::cos(pose.roll) + x * std::sin(pose.roll);
    const double forward = std::cos(pose.down) - tilted * std::sin(pose.down);
    const double fall = std::sin(pose.down) + tilted * std::cos(pose.down);
    double nearest = 1e9;
    const auto offer = [&](double t) {
      if (t > 1e-6) nearest = std::min(nearest, t);
    };
    if (fall > 0.0) {
      const double floor = pose.height / fall;
      if (forward * floor < edge) {
        offer(floor);
      } else {
        offer((pose.height + pit) / fall);
      }
    } else {
      offer((ceiling - pose.height) / -fall);
    }
    if (forward > 0.0) offer(end / forward);
    if (level != 0.0) offer(half_width / std::abs(level));
    for (const SyntheticBox& box : boxes) offer(hit(box, pose, level, forward, fall));
    return nearest;
  }

 private:
  static double hit(const SyntheticBox& box, const CameraPose& pose, double x, double z,
                    double fall) {
    double from = 0.0, to = 1e9;
    const auto clip = [&](double origin, double along, double low, double high) {
      if (std::abs(along) < 1e-12) {
        if (origin < low || origin > high) to = -1.0;
        return;
      }
      const double a = (low - origin) / along;
      const double b = (high - origin) / along;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    };
    clip(0.0, x, box.x0, box.x1);
    clip(0.0, z, box.z0, box.z1);
    clip(pose.height, -fall, 0.0, box.height);
    return from < to ? from : -1.0;
  }
};

/// The frame that the published figures of other pipelines were measured on.
inline SyntheticScene peer_scene() {
  SyntheticScene scene;
  scene.boxes = {
      {-1.2, -0.6, 0.8, 2.0, 2.6}, {0.5, 1.1, 1.7, 3.0, 3.4}, {-0.2, 0.2, 0.4, 1.6, 1.9}};
  scene.noise = 0.0015;
  scene.dropouts = 0.03;
  return scene;
}
inline constexpr CameraPose kPeerPose{.height = 1.0, .forward = 0.2, .down = 0.2617993877991494};

inline DepthImage view_of(const Intrinsics& camera, const std::vector<std::uint16_t>& image) {
  return {camera.width, camera.height, image};
}

}  // namespace usher::depth_pipeline
