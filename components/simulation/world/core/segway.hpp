#pragma once

#include <array>
#include <cstdint>

#include "foundation/random/random.hpp"
#include "simulation/world/core/base.hpp"

namespace usher::world {

/// Constants of the Segway model. The defaults are MARVIN and reproduce table 8.1 of the thesis; a
/// spread is the standard deviation of the draw made for each start or stop.
struct SegwayConfig {
  double wheel_radius = 0.235;   ///< [m]
  double command_timeout = 0.4;  ///< [s] the firmware holds the last command this long
  double dead_time = 0.10;       ///< [s] from a command to the first reaction; at most 0.3
  double max_speed = 3.5;        ///< [m/s] commands are clamped
  double max_turn_rate = 2.5;    ///< [rad/s] commands are clamped

  // Following the command.
  double follow_frequency = 3.5;  ///< [rad/s] of the velocity loop
  double follow_damping = 0.57;   ///< lag on a ramp: dead time + 2 damping / frequency = 0.43 s
  double max_acceleration = 0.7;  ///< [m/s^2] when speeding up

  // Stopping from speed: first a hold, then a fall of speed.
  double follow_limit = 0.3;       ///< [m/s] a larger excess of speed over the command is held
  double hold_deceleration = 0.2;  ///< [m/s^2]
  double hold_time = 0.87;         ///< [s]
  double hold_time_spread = 0.04;  ///< [s]
  double brake_frequency = 3.65;   ///< [rad/s]
  double brake_damping = 0.345;
  double brake_lag = 0.29;  ///< [s] to lean back
  double jerk_lag = 0.03;   ///< [s] how fast the wheels' torque can change

  // Leaning.
  double tip_gain = 0.15;    ///< [rad/(m/s)] tip before the wheels turn, per wanted gain of speed
  double tip_spread = 0.05;  ///< relative
  double tip_fade = 0.3;     ///< [s]
  double tip_frequency = 14.5;      ///< [rad/s]
  double sway_acceleration = 0.05;  ///< [m/s^2] standard deviation of the balancing's sway
  double sway_frequency = 4.0;      ///< [rad/s]

  // Turning.
  double turn_lag = 0.2;                 ///< [s]
  double max_turn_acceleration = 4.0;    ///< [rad/s^2]
  double yaw_per_deceleration = 0.0095;  ///< [rad/(m/s^2)] the wheels do not brake alike
  double yaw_sway = 0.0026;              ///< [rad] standard deviation

  // Emergency stop: motors off, the body falls on its tilt limiters, and these slide.
  double fall_rate = 5.0;           ///< [1/s] unstable pole of the free pendulum
  double fall_push = 2.5;           ///< [rad/s^2] tipping by the drag of the idle motors
  double idle_drag = 0.97;          ///< [m/s^2] deceleration by the idle motors while falling
  double limiter_pitch = 0.351;     ///< [rad] where the limiters touch the floor
  double limiter_spread = 0.011;    ///< [rad]
  double limiter_frequency = 45.0;  ///< [rad/s] of body and limiter as a spring
  double limiter_damping = 0.35;
  double slide_deceleration = 0.44;  ///< [m/s^2]
  double slide_spread = 0.2;         ///< relative, the floor differs
  double slide_yaw_spread = 0.08;    ///< [rad/m]
  double rise_time = 1.0;            ///< [s] to be set upright after a reset

  // What the base's own sensors make of it. Spreads are drawn once, for the life of the base.
  double odometry_scale_spread = 0.003;  ///< relative error of distance
  double odometry_turn_spread = 0.01;    ///< relative error of turns (track)
  double odometry_curl_spread = 0.003;   ///< [rad/m] unequal wheels
  double odometry_slip = 0.0015;         ///< [m/sqrt(m)] noise of each wheel
  double track = 0.5398;                 ///< [m] effective, for turning
  double pitch_noise = 0.0009;           ///< [rad]
  double pitch_rate_noise = 0.005;       ///< [rad/s]
  double yaw_rate_noise = 0.005;         ///< [rad/s] of the gyroscope
  double battery_hours = 8.0;            ///< [h] standing; half of that at 1 m/s
};

/// A self-balancing Segway RMP200 as section 8.1 of the MARVIN thesis measured it.
///
/// Speed v, acceleration a, jerk j of the axle along the heading; c is the command after the dead
/// time, g gravity:
///
///     v' = a + n       a' = j       j' = (j* - j) / jerk_lag              n: sway of the balancing
///     follow:  j* = w^2 sat(c - v) - 2 d w a         w, d: follow_frequency, follow_damping;
///                                                    sat so that speeding up levels off at
///                                                    max_acceleration
///     hold:    j* = (-s hold_deceleration - a) 4/s   s: sign of v
///     brake:   j* = w^2 (r - v) - 2 d w a            w, d: brake_frequency, brake_damping
///              r' = (c - r) / brake_lag              from r = v when the hold ends
///
/// The machine can slow down only after it has leaned back. A speed that exceeds the command by
/// more than follow_limit is therefore held for hold_time, then given up in one swing with
/// overshoot: the two phases of figure 8.1. A command that falls gently (up to about 0.6 m/s^2)
/// never leaves `follow` and lags by about 0.4 s.
///
/// Pitch: the lean that the acceleration needs, and the tip of the body over resting wheels that
/// starts a drive:
///
///     pitch = atan((a + n) / g) + tip,      tip'' = wt^2 (tip_gain h - tip) - 2 0.8 wt tip'
///     h: wanted gain of speed, high-passed with tip_fade; zero when slowing down
///
/// The encoders measure wheel against body, so they report  v - wheel_radius * pitch' : backward
/// when the body tips forward, though the robot stands still (section 8.1.1).
///
/// Turning follows the command with turn_lag; the heading sways by yaw_sway and by
/// yaw_per_deceleration * -a.
///
/// Emergency stop: pitch'' = fall_rate^2 sin(pitch) + fall_push s until the limiters carry (spring
/// and damper), speed falls by idle_drag, from then on by slide_deceleration. It lies there until
/// reset().
class Segway final : public Base {
 public:
  Segway(const SegwayConfig& config, std::uint64_t seed);

  void place(const Pose2& pose) override;
  void command(const Twist2& twist) override;
  void emergency_stop() override;
  void reset() override;
  void step() override;
  void obstruct(const Pose2& pose) override;

 private:
  enum class Mode { kFollow, kHold, kBrake, kFall, kSlide, kRise };

  bool upright() const { return mode_ <= Mode::kBrake; }
  Twist2 delayed_command();
  void sway();
  void choose_mode(double target);
  void balance(const Twist2& target, double h);
  void fall(double h);
  void rise(double h);
  void turn(double target, double h);
  void measure(double rolled, double turned);

  SegwayConfig config_;
  Random motion_;
  Random sensing_;
  Encoders encoders_;

  static constexpr int kDelaySlots = 32;
  std::array<Twist2, kDelaySlots> commands_{};
  int newest_ = 0;
  Twist2 wanted_;
  double wanted_age_ = 0.0;

  Mode mode_ = Mode::kFollow;
  double acceleration_ = 0.0;
  double jerk_ = 0.0;
  double hold_left_ = 0.0;
  double brake_target_ = 0.0;
  double tip_ = 0.0;
  double tip_rate_ = 0.0;
  double tip_level_ = 0.0;
  double tip_strength_ = 1.0;
  bool starting_ = false;
  double sway_raw_ = 0.0;
  double sway_ = 0.0;
  double yaw_sway_raw_ = 0.0;
  double yaw_sway_ = 0.0;
  double yaw_offset_ = 0.0;
  double turn_rate_ = 0.0;
  double fall_side_ = 1.0;
  double limiter_ = 0.0;
  double slide_ = 0.0;
  double slide_curl_ = 0.0;
  double rise_left_ = 0.0;
  double rise_from_ = 0.0;
};

}  // namespace usher::world
