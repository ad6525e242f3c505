#include "simulation/world/core/pioneer.hpp"

#include <algorithm>
#include <cmath>

namespace usher::world {
namespace {

constexpr double kEmergencyFactor = 4.0;

double approach(double value, double target, double lag, double limit) {
  const double step = std::clamp((target - value) / lag, -limit, limit) * kStep;
  return std::abs(step) > std::abs(target - value) ? target : value + step;
}

}  // namespace

Pioneer::Pioneer(const PioneerConfig& config, std::uint64_t seed)
    : config_(config),
      sensing_(stream_seed(seed, "pioneer/sensing")),
      encoders_{.track = config.track,
                .distance_scale = sensing_.gaussian(1.0, config.odometry_scale_spread),
                .turn_scale = sensing_.gaussian(1.0, config.odometry_turn_spread),
                .slip = config.odometry_slip} {}

void Pioneer::place(const Pose2& pose) {
  truth_ = BaseTruth{};
  truth_.pose = pose;
  wanted_ = {};
}

void Pioneer::command(const Twist2& twist) {
  if (!twist.finite()) return;
  wanted_ = {std::clamp(twist.v, -config_.max_speed, config_.max_speed),
             std::clamp(twist.w, -config_.max_turn_rate, config_.max_turn_rate)};
  wanted_age_ = 0.0;
}

void Pioneer::emergency_stop() {
  readings_.emergency = true;
  readings_.motors_on = false;
}

void Pioneer::reset() {
  readings_.emergency = false;
  readings_.motors_on = true;
}

void Pioneer::obstruct(const Pose2& pose) {
  truth_.pose = pose;
  truth_.twist = {};
}

void Pioneer::step() {
  wanted_age_ += kStep;
  const bool obey = !readings_.emergency && wanted_age_ <= config_.command_timeout + 0.5 * kStep;
  const Twist2 target = obey ? wanted_ : Twist2{};
  const double factor = readings_.emergency ? kEmergencyFactor : 1.0;
  truth_.twist = {
      approach(truth_.twist.v, target.v, config_.lag, factor * config_.max_acceleration),
      approach(truth_.twist.w, target.w, config_.lag, factor * config_.max_turn_acceleration)};
  truth_.pose = geometry::integrate(truth_.pose, truth_.twist, kStep);

  count_wheels(encoders_, truth_.twist.v * kStep, truth_.twist.w * kStep, sensing_);
  drain_battery(config_.battery_hours);
  readings_.yaw_rate = truth_.twist.w + config_.yaw_rate_noise * sensing_.gaussian();
}

}  // namespace usher::world
