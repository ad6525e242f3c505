#include "drivers/p3dx/device_sim/component.hpp"

#include <cmath>

#include "wire/conversions.hpp"

namespace usher::p3dx {

namespace {
constexpr auto kSilence = std::chrono::milliseconds(150);
constexpr auto kFiring = std::chrono::milliseconds(40);
constexpr double kLongestStep = 0.5;  // [m] between two reports; more is no way
}  // namespace

P3dxSimComponent::P3dxSimComponent(runtime::Host& host)
    : wheels_{host.parameters().number("robot.track", "m", {0.1, 2}, 0.331,
                                       "Effective distance of the wheels, for turning.")},
      rejected_(host.health().counter("feedback: rejected")),
      base_(host),
      driver_(host, base_.device()),
      sonar_(host.input(
          topics::kSimSensorBoard,
          {.max_age = kSilence, .on_loss = "publishes no sonar ranges", .optional = true},
          [this](const auto& message, const auto&) { take_sonar(message); })) {
  feedback_.sonar.fill(std::numeric_limits<float>::quiet_NaN());
  base_.listen([this](const auto& message) { take(message); },
               [this](const std::string& reason) { driver_.disconnected(reason); });
}

void P3dxSimComponent::take(const usher_sim_msgs::msg::BaseFeedback& message) {
  const double sum = message.left_travel() + message.right_travel() + message.left_velocity() +
                     message.right_velocity();
  if (!std::isfinite(sum)) {
    ++rejected_;
    return;
  }
  const kinematics::WheelSpeeds travel{message.left_travel(), message.right_travel()};
  if (travel_) {
    const double left = travel.left - travel_->left, right = travel.right - travel_->right;
    if (std::abs(left) + std::abs(right) < 2.0 * kLongestStep) {
      feedback_.pose = wheels_.rolled(feedback_.pose, left, right);
    } else {
      ++rejected_;
    }
  }
  travel_ = travel;
  feedback_.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  feedback_.mode = message.emergency()   ? Mode::kEmergency
                   : message.balancing() ? Mode::kReady
                                         : Mode::kStandby;
  feedback_.twist = wheels_.forward({message.left_velocity(), message.right_velocity()});
  feedback_.battery_percent = message.battery_percent();
  driver_.take(feedback_);
  feedback_.sonar.fill(std::numeric_limits<float>::quiet_NaN());
}

void P3dxSimComponent::take_sonar(const usher_sim_msgs::msg::SensorBoardReading& message) {
  if (message.ranges().size() != kSonarSlots) {
    ++rejected_;
    return;
  }
  const Time stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  if (stamp < fires_at_) return;
  fires_at_ = stamp + kFiring;
  for (std::size_t slot = 0; slot < kSonarSlots; ++slot) {
    if (is_sonar(slot)) feedback_.sonar[slot] = message.ranges()[slot];
  }
}

}  // namespace usher::p3dx
