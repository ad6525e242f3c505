#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/geometry/pose2.hpp"

namespace usher::kinematics {

/// Contact at the four corners of the footprint; true is pressed.
struct Whiskers {
  bool front_left = false;
  bool front_right = false;
  bool back_left = false;
  bool back_right = false;
};

/// A turn to this side swings a touched corner outward (the thesis, fig. 6.3): to the left the
/// front left and the back right one.
inline bool bars_turn(const Whiskers& t, double w) {
  return w > 0.0 ? t.front_left || t.back_right : w < 0.0 && (t.front_right || t.back_left);
}

/// The command without the motion that would press a touched corner further (the thesis, fig. 6.3):
/// a front whisker bars forward motion and the turn toward its side; a back whisker bars backward
/// motion and the turn that swings its corner outward. Two refinements, without which a robot
/// beside a wall could never leave it: what touches both corners of a side stands beside it, so
/// that it may creep along and bend away, at `creep` [m/s]; and an arc whose turn is barred is
/// driven straight at half of that only, because only the arc was chosen to be free.
inline geometry::Twist2 whisker_reflex(geometry::Twist2 twist, const Whiskers& whiskers,
                                       double creep) {
  constexpr double kBend = 0.3;  // [1/m] swings the other corner of the side outward by 1.3 cm
  const Whiskers& t = whiskers;
  const bool beside_left = t.front_left && t.back_left;
  const bool beside_right = t.front_right && t.back_right;
  // Both corners of an end: something ahead of it, whatever stands beside.
  const bool bar_forward =
      (t.front_left && (t.front_right || !beside_left)) || (t.front_right && !beside_right);
  const bool bar_backward =
      (t.back_left && (t.back_right || !beside_left)) || (t.back_right && !beside_right);
  if ((twist.v > 0.0 && bar_forward) || (twist.v < 0.0 && bar_backward)) twist.v = 0.0;
  const bool turn_barred = bars_turn(t, twist.w);
  const double most_v = turn_barred ? 0.5 * creep : creep;
  if (beside_left || beside_right || turn_barred) twist.v = std::clamp(twist.v, -most_v, most_v);
  if (!turn_barred) return twist;
  // The leading corner away from what stands beside.
  const bool away = beside_left != beside_right && (twist.v * twist.w < 0.0) == beside_left;
  const double most = away ? kBend * std::abs(twist.v) : 0.0;
  twist.w = std::clamp(twist.w, -most, most);
  return twist;
}

}  // namespace usher::kinematics
