#include "simulation/world/core/segway.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace usher::world {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr int kSubsteps = 4;       // the limiters' spring needs less than 3 ms
constexpr double kHoldRate = 4.0;  // [1/s] how fast the hold's deceleration builds up
constexpr double kTipDamping = 0.8;
constexpr double kStill = 0.05;  // [m/s] slower than this counts as standing

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

// One step of noise with a smooth path: white noise through two equal low-pass filters.
void colored_step(double& raw, double& smooth, double frequency, double sigma, double noise) {
  const double gain = std::sqrt(2.0) * sigma * std::sqrt(2.0 * frequency * kStep);
  raw += -frequency * raw * kStep + gain * noise;
  smooth += frequency * (raw - smooth) * kStep;
}

// A draw that cannot surprise: beyond three standard deviations it is cut.
double draw(Random& random, double mean, double sigma) {
  return mean + sigma * std::clamp(random.gaussian(), -3.0, 3.0);
}

}  // namespace

Segway::Segway(const SegwayConfig& config, std::uint64_t seed)
    : config_(config),
      motion_(stream_seed(seed, "segway/motion")),
      sensing_(stream_seed(seed, "segway/sensing")),
      encoders_{.track = config.track,
                .distance_scale = draw(sensing_, 1.0, config.odometry_scale_spread),
                .turn_scale = draw(sensing_, 1.0, config.odometry_turn_spread),
                .curl = draw(sensing_, 0.0, config.odometry_curl_spread),
                .slip = config.odometry_slip} {
  assert(config.dead_time >= 0.0 && config.dead_time <= (kDelaySlots - 2) * kStep);
}

void Segway::place(const Pose2& pose) {
  truth_ = BaseTruth{};
  truth_.pose = pose;
  mode_ = Mode::kFollow;
  acceleration_ = jerk_ = tip_ = tip_rate_ = tip_level_ = 0.0;
  wanted_ = {};
  commands_.fill({});
}

void Segway::command(const Twist2& twist) {
  if (!twist.finite()) return;
  wanted_ = {std::clamp(twist.v, -config_.max_speed, config_.max_speed),
             std::clamp(twist.w, -config_.max_turn_rate, config_.max_turn_rate)};
  wanted_age_ = 0.0;
}

void Segway::emergency_stop() {
  readings_.emergency = true;
  if (mode_ == Mode::kFall || mode_ == Mode::kSlide) return;
  readings_.motors_on = false;
  mode_ = Mode::kFall;
  fall_side_ = std::abs(truth_.twist.v) > kStill ? sign(truth_.twist.v) : sign(truth_.pitch);
  limiter_ = draw(motion_, config_.limiter_pitch, config_.limiter_spread);
  slide_ = config_.slide_deceleration * draw(motion_, 1.0, config_.slide_spread);
  slide_curl_ = draw(motion_, 0.0, config_.slide_yaw_spread);
}

void Segway::reset() { readings_.emergency = false; }

void Segway::obstruct(const Pose2& pose) {
  truth_.pose = pose;
  truth_.twist = {};
  acceleration_ = jerk_ = 0.0;
}

void Segway::step() {
  const Twist2 target = delayed_command();
  sway();
  if (mode_ == Mode::kSlide && !readings_.emergency && truth_.twist.v == 0.0) {
    mode_ = Mode::kRise;
    rise_left_ = config_.rise_time;
    rise_from_ = truth_.pitch;
  }

  constexpr double kSub = kStep / kSubsteps;
  const Pose2 before = truth_.pose;
  double distance = 0.0;
  double rolled = 0.0;
  double turned = 0.0;
  for (int i = 0; i < kSubsteps; ++i) {
    const double pitch_before = truth_.pitch;
    if (upright()) {
      balance(target, kSub);
    } else if (mode_ == Mode::kRise) {
      rise(kSub);
    } else {
      fall(kSub);
    }
    turn(upright() ? target.w : 0.0, kSub);
    distance += truth_.twist.v * kSub;
    turned += truth_.twist.w * kSub;
    rolled += truth_.twist.v * kSub - config_.wheel_radius * (truth_.pitch - pitch_before);
  }
  truth_.pose = geometry::integrate(before, {distance / kStep, turned / kStep}, kStep);
  measure(rolled, turned);
}

Twist2 Segway::delayed_command() {
  wanted_age_ += kStep;
  newest_ = (newest_ + 1) % kDelaySlots;
  commands_[static_cast<std::size_t>(newest_)] =
      wanted_age_ > config_.command_timeout + 0.5 * kStep ? Twist2{} : wanted_;
  const int delay = static_cast<int>(std::lround(config_.dead_time / kStep));
  return commands_[static_cast<std::size_t>((newest_ + kDelaySlots - delay) % kDelaySlots)];
}

void Segway::sway() {
  colored_step(sway_raw_, sway_, config_.sway_frequency, config_.sway_acceleration,
               motion_.gaussian());
  colored_step(yaw_sway_raw_, yaw_sway_, config_.sway_frequency, config_.yaw_sway,
               motion_.gaussian());
}

void Segway::choose_mode(double target) {
  const double v = truth_.twist.v;
  const double excess = sign(v) * (v - target);
  switch (mode_) {
    case Mode::kFollow:
      if (std::abs(v) > kStill && excess > config_.follow_limit) {
        mode_ = Mode::kHold;
        hold_left_ = draw(motion_, config_.hold_time, config_.hold_time_spread);
      }
      break;
    case Mode::kHold:
      if (excess < config_.follow_limit) {
        mode_ = Mode::kFollow;
      } else if (hold_left_ <= 0.0) {
        mode_ = Mode::kBrake;
        brake_target_ = v;
      }
      break;
    case Mode::kBrake: {
      const bool settled = std::abs(v - target) < kStill && std::abs(acceleration_) < 0.1;
      const bool wanted_faster = excess < 0.0 && v * target > 0.0;
      if (settled || wanted_faster) mode_ = Mode::kFollow;
      break;
    }
    default:
      break;
  }
}

void Segway::balance(const Twist2& target, double h) {
  choose_mode(target.v);
  double& v = truth_.twist.v;
  const double error = target.v - v;
  brake_target_ += (target.v - brake_target_) * h / config_.brake_lag;
  const bool speeding_up = error * v >= 0.0;

  double wanted_jerk = 0.0;
  if (mode_ == Mode::kHold) {
    hold_left_ -= h;
    wanted_jerk = kHoldRate * (-sign(v) * config_.hold_deceleration - acceleration_);
  } else {
    const bool brake = mode_ == Mode::kBrake;
    const double frequency = brake ? config_.brake_frequency : config_.follow_frequency;
    const double damping = brake ? config_.brake_damping : config_.follow_damping;
    const double limit =
        speeding_up ? 2.0 * damping / frequency * config_.max_acceleration : config_.follow_limit;
    const double gap = brake ? brake_target_ - v : std::clamp(error, -limit, limit);
    wanted_jerk = frequency * frequency * gap - 2.0 * damping * frequency * acceleration_;
  }
  jerk_ += (wanted_jerk - jerk_) * h / config_.jerk_lag;
  acceleration_ += jerk_ * h;
  v += (acceleration_ + sway_) * h;

  // The tip of the body: only a wanted gain of speed in the commanded direction tips it.
  const double gain = mode_ != Mode::kHold && error * target.v > 0.0 ? error : 0.0;
  if (std::abs(gain) < std::abs(tip_level_) || gain * tip_level_ < 0.0) tip_level_ = gain;
  const double wash = gain - tip_level_;
  if (std::abs(wash) > kStill && !starting_) {
    tip_strength_ = draw(motion_, 1.0, config_.tip_spread);
  }
  starting_ = std::abs(wash) > kStill;
  tip_level_ += wash * h / config_.tip_fade;
  const double frequency = config_.tip_frequency;
  tip_rate_ += h * (frequency * frequency * (tip_strength_ * config_.tip_gain * wash - tip_) -
                    2.0 * kTipDamping * frequency * tip_rate_);
  tip_ += tip_rate_ * h;

  const double pitch = std::atan((acceleration_ + sway_) / kGravity) + tip_;
  truth_.pitch_rate = (pitch - truth_.pitch) / h;
  truth_.pitch = pitch;
}

void Segway::fall(double h) {
  double push = config_.fall_rate * config_.fall_rate * std::sin(truth_.pitch) +
                fall_side_ * config_.fall_push;
  const double depth = fall_side_ * truth_.pitch - limiter_;
  if (depth > 0.0) {
    const double frequency = config_.limiter_frequency;
    push -= fall_side_ * frequency * frequency * depth +
            2.0 * config_.limiter_damping * frequency * truth_.pitch_rate;
    mode_ = Mode::kSlide;
  }
  truth_.pitch_rate += push * h;
  truth_.pitch += truth_.pitch_rate * h;

  const double loss = (mode_ == Mode::kFall ? config_.idle_drag : slide_) * h;
  double& v = truth_.twist.v;
  v = std::abs(v) <= loss ? 0.0 : v - sign(v) * loss;
  acceleration_ = jerk_ = tip_ = tip_rate_ = tip_level_ = 0.0;
}

void Segway::rise(double h) {
  rise_left_ = std::max(0.0, rise_left_ - h);
  const double left = rise_left_ / config_.rise_time;
  const double pitch = rise_from_ * left * left * (3.0 - 2.0 * left);
  truth_.pitch_rate = (pitch - truth_.pitch) / h;
  truth_.pitch = pitch;
  truth_.twist = {};
  if (rise_left_ == 0.0) {
    mode_ = Mode::kFollow;
    readings_.motors_on = true;
  }
}

void Segway::turn(double target, double h) {
  double& w = truth_.twist.w;
  if (mode_ == Mode::kSlide) {
    w = slide_curl_ * truth_.twist.v;
    return;
  }
  // The turn that was commanded; what the heading sways beside it comes on top.
  const double limit = config_.max_turn_acceleration;
  turn_rate_ += std::clamp((target - turn_rate_) / config_.turn_lag, -limit, limit) * h;
  const double offset = yaw_sway_ - config_.yaw_per_deceleration * acceleration_;
  w = turn_rate_ + (offset - yaw_offset_) / h;
  yaw_offset_ = offset;
}

void Segway::measure(double rolled, double turned) {
  count_wheels(encoders_, rolled, turned, sensing_);
  drain_battery(config_.battery_hours);
  readings_.yaw_rate = truth_.twist.w + config_.yaw_rate_noise * sensing_.gaussian();
  readings_.pitch = truth_.pitch + config_.pitch_noise * sensing_.gaussian();
  readings_.pitch_rate = truth_.pitch_rate + config_.pitch_rate_noise * sensing_.gaussian();
}

}  // namespace usher::world
