#pragma once

#include "foundation/kinematics/torso.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// What the joints of the robot's torso can do, from the parameters robot.torso.*. Without them
/// there is no torso: nothing moves. A joint whose low end is above its high end ends the component
/// with the reason.
kinematics::TorsoLimits read_torso_limits(runtime::Host& host);

}  // namespace usher::wire
