#include "drivers/segway_rmp/emulator/component.hpp"

#include "drivers/segway_rmp/shell/sim_feedback.hpp"

namespace usher::segway_rmp {

namespace {

using runtime::HealthState;
using namespace usher_sim_msgs::msg::BaseCommand_Constants;

constexpr auto kSilence = std::chrono::milliseconds(150);

}  // namespace

SegwayEmulatorComponent::SegwayEmulatorComponent(runtime::Host& host)
    : host_(host),
      base_(Calibration{}),
      skipped_(host.health().counter("bytes: skipped")),
      command_(host.output(topics::kSimBaseCommand)),
      feedback_(host.input(topics::kSimBaseFeedback,
                           {.max_age = kSilence, .on_loss = "says nothing on the line"},
                           [this](const auto& message, const auto&) { speak(message); })) {
  const std::string address = host.parameters().text("address", "listen://127.0.0.1:7420",
                                                     "Where the driver finds the emulated base.");
  line_ = &host.open_stream(
      address, {.on_open = [this] { host_.health().set(HealthState::kOk); },
                .on_bytes =
                    [this](std::span<const std::uint8_t> bytes) {
                      base_.received(bytes, [this](const auto& order) { obey(order); });
                      skipped_ = base_.skipped_bytes();
                    },
                // Without a driver the base's firmware stops by itself: nothing is commanded.
                .on_close = [this](const std::string&) { base_ = EmulatedBase(Calibration{}); }});
  host.health().set(HealthState::kOk);
}

void SegwayEmulatorComponent::obey(const EmulatedBase::Order& order) {
  using Wish = EmulatedBase::Wish;
  // A driver that connects sets the balance mode: for a base that stands this is nothing new.
  if (order.wish == Wish::kBalance && !emergency_) return;
  // The world minds the newest command only; the firmware has heard each.
  if (order.wish != Wish::kDrive) resetting_ = order.wish == Wish::kBalance;
  usher_sim_msgs::msg::BaseCommand message;
  message.mode(order.wish == Wish::kShutdown ? MODE_EMERGENCY_STOP
               : resetting_                  ? MODE_RESET
                                             : MODE_DRIVE);
  message.v(order.twist.v);
  message.w(order.twist.w);
  command_.publish(message);
}

void SegwayEmulatorComponent::speak(const usher_sim_msgs::msg::BaseFeedback& message) {
  emergency_ = message.emergency();
  resetting_ = resetting_ && emergency_;
  line_->write(base_.feedback(from_message(message)));
}

}  // namespace usher::segway_rmp
