#pragma once

#include "control/movement_control/core/movement_control.hpp"

namespace usher::movement_control {

/// Everything is well, wide and enabled for navigation.
inline Inputs all_well() {
  Inputs inputs;
  inputs.enables = Enables{true, true, true, true, 1.0};
  inputs.whiskers = Whiskers{};
  inputs.person_ahead = false;
  inputs.situation = Situation::kOpen;
  inputs.localization = Localization::kGood;
  inputs.measured = geometry::Twist2{};
  inputs.view.sees = true;
  return inputs;
}

inline Parameters with_jerk() {
  Parameters parameters;
  parameters.jerk = {1.0, 4.0};
  return parameters;
}

}  // namespace usher::movement_control
