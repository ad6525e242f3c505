#pragma once

#include "foundation/geometry/footprint.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// The robot's outline on the floor in base_footprint, from the parameter robot.footprint:
/// counter-clockwise corners of a convex polygon around the origin. What is none ends the component
/// with the reason. While a component is only described, or refused for its parameters, there is
/// none: then it is a square of 0.1 m.
geometry::Footprint read_footprint(runtime::Host& host);

}  // namespace usher::wire
