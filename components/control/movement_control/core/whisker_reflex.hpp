#pragma once

#include "foundation/geometry/pose2.hpp"

namespace usher::movement_control {

/// Contact at the four corners of the footprint; true is pressed.
struct Whiskers {
  bool front_left = false;
  bool front_right = false;
  bool back_left = false;
  bool back_right = false;
};

/// The command without the motion that would press a touched corner further (the thesis, fig. 6.3):
/// a front whisker bars forward motion and the turn toward its side; a back whisker bars backward
/// motion and the turn that swings its corner outward.
constexpr geometry::Twist2 whisker_reflex(geometry::Twist2 twist, const Whiskers& whiskers) {
  const bool bar_forward = whiskers.front_left || whiskers.front_right;
  const bool bar_backward = whiskers.back_left || whiskers.back_right;
  // Turning left moves the front left corner outward, and the back right one.
  const bool bar_left = whiskers.front_left || whiskers.back_right;
  const bool bar_right = whiskers.front_right || whiskers.back_left;
  if ((twist.v > 0.0 && bar_forward) || (twist.v < 0.0 && bar_backward)) twist.v = 0.0;
  if ((twist.w > 0.0 && bar_left) || (twist.w < 0.0 && bar_right)) twist.w = 0.0;
  return twist;
}

}  // namespace usher::movement_control
