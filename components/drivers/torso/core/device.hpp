#pragma once

#include <chrono>

#include "foundation/kinematics/torso.hpp"

namespace usher::torso {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// Joints and eyes at one moment: what the thesis calls a torso frame (6.2).
struct TorsoFrame {
  kinematics::TorsoPose joints{};
  kinematics::EyeColor left_eye{};
  kinematics::EyeColor right_eye{};
};

/// Where the torso is, however it was obtained.
struct Reading {
  Time stamp{};        ///< on the host's clock
  TorsoFrame frame;    ///< measured, eyes as shown
  bool moves = false;  ///< the servos are on and the board obeys
};

}  // namespace usher::torso
