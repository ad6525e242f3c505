#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "simulation/rendering/core/body.hpp"

namespace usher::rendering {

/// Rays from one point: number k goes along `start` + x[k] * `right`.
struct RowOfRays {
  Eigen::Vector3f start, right;
};

/// Where rays meet a limb.
struct LimbHits {
  static constexpr std::size_t kMost = 64;
  /// In units of the ray's direction; infinity: not at all.
  std::array<float, kMost> distance;
  /// Between ray and normal; only where it is met.
  std::array<float, kMost> cosine;
};

/// A limb as one point sees it. The hull of two balls is swept by a ball whose centre and radius
/// change evenly from the one to the other: where a ray enters it, it enters the first ball, the
/// last one, or the cone that touches both.
class LimbRays {
 public:
  LimbRays(const Limb& limb, const Eigen::Vector3f& from);

  /// At most LimbHits::kMost rays. The point lies outside the limb.
  void meet(const RowOfRays& rays, std::span<const float> x, LimbHits& hits) const;

 private:
  Eigen::Vector3f axis_, away_;      // from ball to ball; from the first ball to the point
  float radius_, narrowing_;         // of the first ball; by the last one
  float outside_from_, outside_to_;  // squared distance of the centre less the squared radius
  // The cone: a centre at the share s of the axis touches it where s * steep = lag + along * t.
  float steep_, lag_, outside_cone_;
};

}  // namespace usher::rendering
