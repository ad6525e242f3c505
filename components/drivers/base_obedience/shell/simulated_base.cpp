#include "drivers/base_obedience/shell/simulated_base.hpp"

#include <utility>

namespace usher::drive {

namespace {
using namespace usher_sim_msgs::msg::BaseCommand_Constants;
constexpr auto kSilence = std::chrono::milliseconds(150);
}  // namespace

SimulatedBase::SimulatedBase(runtime::Host& host)
    : host_(host), pending_(MODE_DRIVE), command_(host.output(topics::kSimBaseCommand)) {}

BaseDevice SimulatedBase::device() {
  return {.drive = [this](const geometry::Twist2& twist) { send(pending_, twist); },
          .emergency_stop = [this] { send(pending_ = MODE_EMERGENCY_STOP, {}); },
          .reset = [this] { send(pending_ = MODE_RESET, {}); }};
}

void SimulatedBase::listen(std::function<void(const Feedback&)> take,
                           std::function<void(const std::string&)> silent) {
  feedback_ = host_.input(
      topics::kSimBaseFeedback,
      {.max_age = kSilence, .on_loss = "reports the base as disconnected"},
      [this, take = std::move(take)](const auto& message, const auto&) {
        if (pending_ == (message.emergency() ? MODE_EMERGENCY_STOP : MODE_RESET))
          pending_ = MODE_DRIVE;
        take(message);
      },
      [silent = std::move(silent)] { silent("the base is silent"); });
}

void SimulatedBase::send(std::uint8_t mode, const geometry::Twist2& twist) {
  usher_sim_msgs::msg::BaseCommand message;
  message.mode(mode);
  message.v(twist.v);
  message.w(twist.w);
  command_.publish(message);
}

}  // namespace usher::drive
