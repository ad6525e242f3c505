#include "drivers/segway_rmp/device_sim/component.hpp"

#include "drivers/segway_rmp/shell/sim_feedback.hpp"

namespace usher::segway_rmp {

namespace {

using namespace usher_sim_msgs::msg::BaseCommand_Constants;

constexpr auto kSilence = std::chrono::milliseconds(150);

}  // namespace

SegwayRmpSimComponent::SegwayRmpSimComponent(runtime::Host& host)
    : command_(host.output(topics::kSimBaseCommand)),
      driver_(host, {.drive = [this](const geometry::Twist2& twist) { send(pending_, twist); },
                     .emergency_stop = [this] { send(pending_ = MODE_EMERGENCY_STOP, {}); },
                     .reset = [this] { send(pending_ = MODE_RESET, {}); }}),
      feedback_(host.input(
          topics::kSimBaseFeedback,
          {.max_age = kSilence, .on_loss = "reports the base as disconnected"},
          [this](const auto& message, const auto&) {
            if (pending_ == (message.emergency() ? MODE_EMERGENCY_STOP : MODE_RESET))
              pending_ = MODE_DRIVE;
            driver_.take(from_message(message));
          },
          [this] { driver_.disconnected("the base is silent"); })) {}

void SegwayRmpSimComponent::send(std::uint8_t mode, const geometry::Twist2& twist) {
  usher_sim_msgs::msg::BaseCommand message;
  message.mode(mode);
  message.v(twist.v);
  message.w(twist.w);
  command_.publish(message);
}

}  // namespace usher::segway_rmp
