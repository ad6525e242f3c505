#include "drivers/segway_rmp/device_sim/component.hpp"

#include "drivers/segway_rmp/shell/sim_feedback.hpp"

namespace usher::segway_rmp {

SegwayRmpSimComponent::SegwayRmpSimComponent(runtime::Host& host)
    : base_(host), driver_(host, base_.device()) {
  base_.listen([this](const auto& message) { driver_.take(from_message(message)); },
               [this](const std::string& reason) { driver_.disconnected(reason); });
}

}  // namespace usher::segway_rmp
