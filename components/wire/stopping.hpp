#pragma once

#include "foundation/kinematics/stopping_distance.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// The base's measured stopping distance, from the parameters robot.stopping.speeds and
/// robot.stopping.distances. What is none ends the component with the reason.
kinematics::StoppingDistance read_stopping(runtime::Host& host);

}  // namespace usher::wire
