#pragma once

#include "control/interaction_control/core/posing.hpp"
#include "runtime/api/host.hpp"

namespace usher::interaction_control {

/// The thresholds of appendix A.2.
Zones::Thresholds read_thresholds(runtime::Parameters& parameters);

/// The zones of the parameter `zones`; the error says which makes no sense, and why.
Result<Zones> read_zones(runtime::Parameters& parameters, const Zones::Thresholds& thresholds,
                         const kinematics::TorsoLimits& limits);

/// Zones, joints and all else that poses need. A zone that makes no sense, or a rest that is none,
/// ends the component with the reason.
Posing read_posing(runtime::Host& host, const Zones::Thresholds& thresholds);

}  // namespace usher::interaction_control
