#include "simulation/rendering/core/limb_rays.hpp"

#include <cmath>
#include <limits>

namespace usher::rendering {

LimbRays::LimbRays(const Limb& limb, const Eigen::Vector3f& from)
    : axis_(limb.to - limb.from),
      away_(from - limb.from),
      radius_(limb.from_radius),
      narrowing_(limb.from_radius - limb.to_radius),
      outside_from_(away_.squaredNorm() - limb.from_radius * limb.from_radius),
      outside_to_((from - limb.to).squaredNorm() - limb.to_radius * limb.to_radius),
      steep_(axis_.squaredNorm() - narrowing_ * narrowing_),
      lag_(axis_.dot(away_) - narrowing_ * radius_),
      outside_cone_(steep_ * outside_from_ - lag_ * lag_) {}

/// With p = away + t * ray, what touches a ball of the sweep satisfies |p - s axis|^2 =
/// (radius - s narrowing)^2, and no other ball of it: its derivative by s is zero. That gives s,
/// and without s a quadratic equation for t.
void LimbRays::meet(const RowOfRays& rays, std::span<const float> x, LimbHits& hits) const {
  constexpr float kNever = std::numeric_limits<float>::infinity();
  const float axis_start = axis_.dot(rays.start), axis_right = axis_.dot(rays.right);
  const float away_start = away_.dot(rays.start), away_right = away_.dot(rays.right);
  const float start_start = rays.start.squaredNorm(), right_right = rays.right.squaredNorm();
  const float start_right = 2.0F * rays.start.dot(rays.right);
  const float per_steep = steep_ > 0.0F ? 1.0F / steep_ : kNever;  // else one ball holds the other
  const std::size_t count = x.size();
  for (std::size_t i = 0; i < count; ++i) {
    const float along = axis_start + x[i] * axis_right;
    const float toward = away_start + x[i] * away_right;
    const float square = start_start + x[i] * (start_right + x[i] * right_right);
    // Roots of negative numbers are NaN and fail every comparison.
    const float first = (-toward - std::sqrt(toward * toward - square * outside_from_)) / square;
    const float beyond = toward - along;
    const float last = (-beyond - std::sqrt(beyond * beyond - square * outside_to_)) / square;

    const float a = steep_ * square - along * along;
    const float b = steep_ * toward - lag_ * along;
    const float root = std::sqrt(b * b - a * outside_cone_);
    const float entry = (-b - root) / a, other = (-b + root) / a;
    const float share_of_entry = (lag_ + entry * along) * per_steep;
    // Steeper than the cone, a ray meets each of its two halves once.
    const bool second = a < 0.0F && !(share_of_entry >= 0.0F && share_of_entry <= 1.0F);
    const float cone = second ? other : entry;
    const float share = (lag_ + cone * along) * per_steep;

    float best = first > 0.0F ? first : kNever;
    float at = 0.0F;
    const bool by_last = last > 0.0F && last < best;
    best = by_last ? last : best;
    at = by_last ? 1.0F : at;
    const bool by_cone = cone > 0.0F && cone < best && share >= 0.0F && share <= 1.0F;
    best = by_cone ? cone : best;
    at = by_cone ? share : at;
    hits.distance[i] = best;
    hits.cosine[i] = std::abs(toward + best * square - at * along) /
                     (std::sqrt(square) * (radius_ - at * narrowing_));
  }
}

}  // namespace usher::rendering
