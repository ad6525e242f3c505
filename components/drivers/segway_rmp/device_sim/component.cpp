#include "drivers/segway_rmp/device_sim/component.hpp"

#include "wire/conversions.hpp"

namespace usher::segway_rmp {

namespace {

using namespace usher_sim_msgs::msg::BaseCommand_Constants;

constexpr auto kSilence = std::chrono::milliseconds(150);

SegwayFeedback from_message(const usher_sim_msgs::msg::BaseFeedback& message) {
  SegwayFeedback feedback;
  feedback.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  feedback.mode = message.emergency()   ? Mode::kEmergency
                  : message.balancing() ? Mode::kBalancing
                                        : Mode::kStandby;
  feedback.pitch = message.pitch();
  feedback.pitch_rate = message.pitch_rate();
  feedback.yaw_rate = message.yaw_rate();
  feedback.left_velocity = message.left_velocity();
  feedback.right_velocity = message.right_velocity();
  feedback.left_travel = message.left_travel();
  feedback.right_travel = message.right_travel();
  feedback.battery_percent = message.battery_percent();
  return feedback;
}

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
