#include "foundation/kinematics/whisker_rods.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace usher::kinematics {

namespace {

constexpr double kNear = 0.08;  // [m]

}  // namespace

WhiskerRods::WhiskerRods(const geometry::Footprint& outline, const WhiskerMount& mount)
    : rod_(mount.length * std::cos(mount.outward), mount.length * std::sin(mount.outward)) {
  assert(mount.length > 0.0);
  for (const geometry::Point2& corner : outline.corners()) {
    front_ = std::max(front_, corner.x());
    back_ = std::max(back_, -corner.x());
    side_ = std::max(side_, std::abs(corner.y()));
  }
  reach_ = std::hypot(std::max(front_, back_), side_) + mount.length + kNear;
}

Whiskers WhiskerRods::at(std::span<const geometry::Point2> points, int least) const {
  std::array<int, 4> near{};  // front left, front right, back left, back right
  for (const geometry::Point2& point : points) {
    const bool behind = point.x() < 0.0, right = point.y() < 0.0;
    const geometry::Point2 from_corner(std::abs(point.x()) - (behind ? back_ : front_),
                                       std::abs(point.y()) - side_);
    const double along = std::clamp(from_corner.dot(rod_) / rod_.squaredNorm(), 0.0, 1.0);
    if ((from_corner - along * rod_).norm() <= kNear)
      ++near[2 * static_cast<std::size_t>(behind) + static_cast<std::size_t>(right)];
  }
  return {near[0] >= least, near[1] >= least, near[2] >= least, near[3] >= least};
}

}  // namespace usher::kinematics
