#pragma once

#include <span>

#include "foundation/geometry/angle.hpp"
#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/whisker_reflex.hpp"

namespace usher::kinematics {

/// How a whisker stands out from its corner (the thesis, 3.2.1).
struct WhiskerMount {
  double length = 0.4;                       ///< [m] {> 0}
  double outward = geometry::radians(20.0);  ///< [rad] from straight ahead, or straight back
};

/// The four whiskers as they are while nothing bends them: straight rods from the corners of the
/// rectangle around the outline. Tells whether a touch may be that of something that is known
/// anyway.
class WhiskerRods {
 public:
  WhiskerRods(const geometry::Footprint& outline, const WhiskerMount& mount);

  /// [m] from the axle's middle: what is farther away is at no whisker.
  double reach() const { return reach_; }

  /// Which whiskers lie where a laser saw something: at two of its points in base_footprint, within
  /// 8 cm, which are a cell and the error of pose and laser. One may be noise.
  Whiskers at_seen(std::span<const geometry::Point2> points) const { return at(points, 2); }
  /// Which lie where the local costs know something: at the centers of three lethal cells, one of
  /// which is the touch's own mark.
  Whiskers at_known(std::span<const geometry::Point2> cells) const { return at(cells, 3); }

 private:
  Whiskers at(std::span<const geometry::Point2> points, int least) const;

  double front_ = 0.0, back_ = 0.0, side_ = 0.0;  // [m] of the corners
  geometry::Point2 rod_;                          // [m] from a corner to the tip, ahead and outward
  double reach_ = 0.0;
};

inline bool any(const Whiskers& t) {
  return t.front_left || t.front_right || t.back_left || t.back_right;
}

inline Whiskers operator|(const Whiskers& a, const Whiskers& b) {
  return {a.front_left || b.front_left, a.front_right || b.front_right, a.back_left || b.back_left,
          a.back_right || b.back_right};
}

/// What of the touches is not among the known ones.
inline Whiskers without(const Whiskers& touches, const Whiskers& known) {
  return {touches.front_left && !known.front_left, touches.front_right && !known.front_right,
          touches.back_left && !known.back_left, touches.back_right && !known.back_right};
}

}  // namespace usher::kinematics
