#include "drivers/sensor_board/device_sim/component.hpp"

#include <algorithm>

#include "wire/conversions.hpp"

namespace usher::sensor_board {

namespace {
constexpr auto kSilence = std::chrono::milliseconds(200);
constexpr auto kPeriod = std::chrono::milliseconds(50);  // of SENSORS
}  // namespace

SensorBoardSimComponent::SensorBoardSimComponent(runtime::Host& host)
    : host_(host),
      command_(host.output(topics::kSimSensorBoardCommand)),
      publisher_(host, [this](double tilt) { set_tilt(tilt); }),
      rejected_(host.health().counter("readings: rejected")),
      input_(host.input(
          topics::kSimSensorBoard,
          {.max_age = kSilence, .on_loss = "publishes nothing and says so"},
          [this](const auto& message, const auto&) { take(message); },
          [this] { host_.health().set(runtime::HealthState::kDegraded, "the board is silent"); })) {
}

void SensorBoardSimComponent::set_tilt(double tilt) {
  usher_sim_msgs::msg::SensorBoardCommand command;
  command.tilt(tilt);
  command_.publish(command);
}

void SensorBoardSimComponent::take(const usher_sim_msgs::msg::SensorBoardReading& message) {
  if (message.ranges().size() != kSonars) {
    ++rejected_;
    return;
  }
  Reading reading;
  reading.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  std::copy(message.ranges().begin(), message.ranges().end(), reading.ranges.begin());
  reading.whiskers = {message.front_left(), message.front_right(), message.back_left(),
                      message.back_right()};
  reading.tilt = message.tilt();
  reading.measured = reading.stamp >= measure_at_;
  if (reading.measured) {
    const bool steady = reading.stamp < measure_at_ + kPeriod;
    measure_at_ = (steady ? measure_at_ : reading.stamp) + kPeriod;
  }
  faults_.take(reading);
  publisher_.publish(reading);
  const std::string reason = faults_.reason();
  host_.health().set(reason.empty() ? runtime::HealthState::kOk : runtime::HealthState::kDegraded,
                     reason);
}

}  // namespace usher::sensor_board
