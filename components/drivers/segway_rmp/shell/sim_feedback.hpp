#pragma once

#include "drivers/segway_rmp/core/device.hpp"
#include "idl/topics.hpp"

namespace usher::segway_rmp {

/// What the simulated wheels report, as any back end delivers it.
SegwayFeedback from_message(const usher_sim_msgs::msg::BaseFeedback& message);

}  // namespace usher::segway_rmp
