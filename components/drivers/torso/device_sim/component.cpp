#include "drivers/torso/device_sim/component.hpp"

#include "wire/conversions.hpp"

namespace usher::torso {

namespace {
constexpr auto kSilence = std::chrono::milliseconds(200);
constexpr const char* kSilent = "the torso is silent";
}  // namespace

TorsoSimComponent::TorsoSimComponent(runtime::Host& host)
    : driver_(host),
      command_(host.output(topics::kSimTorsoCommand)),
      rejected_(host.health().counter("readings: rejected")),
      input_(host.input(
          topics::kSimTorso, {.max_age = kSilence, .on_loss = "publishes nothing and says so"},
          [this](const auto& message, const auto&) { take(message); },
          [this] { driver_.lost(kSilent); })),
      timer_(host.timer("tick", kTick, [this](auto) { tick(); })) {}

void TorsoSimComponent::take(const usher_sim_msgs::msg::TorsoReading& message) {
  if (!kinematics::finite(message.joints())) {
    ++rejected_;
    return;
  }
  driver_.measured({wire::from_message(message.header().stamp()).time_since_epoch(),
                    {message.joints(), message.left_eye(), message.right_eye()},
                    true},
                   "");
}

void TorsoSimComponent::tick() {
  const auto frame = input_.fresh() != nullptr ? driver_.step() : std::nullopt;
  if (!frame) return;
  usher_sim_msgs::msg::TorsoCommand command;
  command.joints(frame->joints);
  command.left_eye(frame->left_eye);
  command.right_eye(frame->right_eye);
  command_.publish(command);
}

}  // namespace usher::torso
