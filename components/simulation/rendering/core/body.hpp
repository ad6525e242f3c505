#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "simulation/rendering/core/clothes.hpp"

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

/// [m] The highest point of a body; of who walks, as if he stood.
/// @param height [m] when standing upright
double top_of(Posture posture, double height);

struct Body {
  geometry::Pose2 pose;  ///< on the floor below the hips, x axis where the person looks
  double height = 1.75;  ///< [m] {0.8..2.2} when standing upright
  double width = 1.0;    ///< {0.7..1.5} girth, times the usual one
  Posture posture = Posture::kStanding;
  double phase = 0.0;                             ///< [rad] of the stride while walking
  std::optional<Clothes> clothes = std::nullopt;  ///< none: a color by its number
};

/// A limb: the hull of two balls.
struct Limb {
  Eigen::Vector3f from, to;                    ///< [m] in world
  float from_radius = 0.0F, to_radius = 0.0F;  ///< [m]
};

/// Head, trunk, arms and legs of a body by usual proportions; `limbs` is cleared first.
void make_limbs(const Body& body, std::vector<Limb>& limbs);

/// Where the clothes of trunk and arms begin and those of the legs end: on the plane through
/// `middle`, `up` is the side of the trunk.
struct Waist {
  Eigen::Vector3f middle, up;
};
Waist waist_of(const Body& body, const std::vector<Limb>& limbs);

}  // namespace usher::rendering
