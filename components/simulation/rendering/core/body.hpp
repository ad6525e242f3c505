#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::rendering {

/// How a person holds itself.
enum class Posture : std::uint8_t {
  kStanding = 0,
  kWalking = 1,
  kSitting = 2,  ///< on a seat 0.45 m high, which is not part of the body
  kSquatting = 3,
  kBending = 4,
  kArmsOut = 5,
};

struct Body {
  geometry::Pose2 pose;  ///< on the floor below the hips, x axis where the person looks
  double height = 1.75;  ///< [m] {0.8..2.2} when standing upright
  double width = 1.0;    ///< {0.7..1.5} girth, times the usual one
  Posture posture = Posture::kStanding;
  double phase = 0.0;  ///< [rad] of the stride while walking
};

/// A limb: the hull of two balls.
struct Limb {
  Eigen::Vector3f from, to;                    ///< [m] in world
  float from_radius = 0.0F, to_radius = 0.0F;  ///< [m]
};

/// Head, trunk, arms and legs of a body by usual proportions; `limbs` is cleared first.
void make_limbs(const Body& body, std::vector<Limb>& limbs);

}  // namespace usher::rendering
