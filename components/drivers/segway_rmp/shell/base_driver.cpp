#include "drivers/segway_rmp/shell/base_driver.hpp"

#include <utility>

namespace usher::segway_rmp {

namespace {

using runtime::HealthState;

Odometry::Parameters read_odometry(runtime::Parameters& parameters, double wheel_radius) {
  Odometry::Parameters p;
  p.wheel_radius = wheel_radius;
  p.track = parameters.number("robot.track", "m", {0.1, 2}, p.track,
                              "Effective distance of the wheels, for turning.");
  return p;
}

}  // namespace

BaseDriver::BaseDriver(runtime::Host& host, drive::BaseDevice device)
    : host_(host),
      base_(host, std::move(device), Odometry::Parameters{}.wheel_radius),
      odometry_(read_odometry(host.parameters(), base_.wheel_radius())),
      rejected_feedback_(host.health().counter("feedback: rejected")) {
  if (const auto wheels = read_wheels(base_.found_beside_odometry())) odometry_.resume(*wheels);
  base_.keep_beside_odometry([this] {
    const auto wheels = odometry_.wheels();
    return wheels ? to_text(*wheels) : std::string();
  });
}

void BaseDriver::take(const SegwayFeedback& feedback) {
  const bool understood = odometry_.update(feedback);
  if (understood)
    base_.publish_odometry(feedback.stamp, odometry_.pose(), odometry_.twist(), feedback.pitch);
  rejected_feedback_ = odometry_.rejected();
  if (!understood) {
    host_.health().set(HealthState::kDegraded, "the base's measurements cannot be used");
    return;  // nothing that anybody may drive by: its status grows stale
  }
  base_.report({.stamp = feedback.stamp,
                .state = static_cast<std::uint8_t>(feedback.mode),
                .pitch = feedback.pitch,
                .pitch_rate = feedback.pitch_rate,
                .twist = odometry_.twist(),
                .battery_percent = feedback.battery_percent});
  const bool balances = feedback.mode == Mode::kBalancing;
  if (!balances) {
    host_.health().set(HealthState::kDegraded,
                       "the base does not balance" + (warning_.empty() ? "" : ": " + warning_));
  } else {
    host_.health().set(warning_.empty() ? HealthState::kOk : HealthState::kDegraded, warning_);
  }
}

void BaseDriver::disconnected(const std::string& reason) {
  odometry_.interrupt();
  base_.disconnected(reason);
}

}  // namespace usher::segway_rmp
