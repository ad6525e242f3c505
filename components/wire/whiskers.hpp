#pragma once

#include "foundation/kinematics/whisker_rods.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// How the robot's whiskers stand out from its corners, from the parameters robot.whiskers.*.
kinematics::WhiskerMount read_whiskers(runtime::Host& host);

}  // namespace usher::wire
