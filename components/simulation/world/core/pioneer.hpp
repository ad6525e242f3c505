#pragma once

#include <cstdint>

#include "foundation/random/random.hpp"
#include "simulation/world/core/base.hpp"

namespace usher::world {

/// Constants of a plain differential drive; the defaults are a Pioneer 3-DX.
struct PioneerConfig {
  double command_timeout = 0.6;        ///< [s] the controller's watchdog
  double max_speed = 1.2;              ///< [m/s] commands are clamped
  double max_turn_rate = 3.0;          ///< [rad/s]
  double max_acceleration = 0.6;       ///< [m/s^2]
  double max_turn_acceleration = 2.5;  ///< [rad/s^2]
  double lag = 0.1;                    ///< [s] of the wheels' velocity loops
  double track = 0.331;                ///< [m]

  double odometry_scale_spread = 0.01;  ///< relative error of distance, drawn once
  double odometry_turn_spread = 0.02;   ///< relative error of turns, drawn once
  double odometry_slip = 0.002;         ///< [m/sqrt(m)] noise of each wheel
  double yaw_rate_noise = 0.01;         ///< [rad/s] of the gyroscope
  double battery_hours = 6.0;           ///< [h] standing; half of that at 1 m/s
};

/// A differential drive that does not lean: both velocities follow the command with a first-order
/// lag under a limit of acceleration. An emergency stop blocks the wheels at max_acceleration times
/// four.
class Pioneer final : public Base {
 public:
  Pioneer(const PioneerConfig& config, std::uint64_t seed);

  void place(const Pose2& pose) override;
  void command(const Twist2& twist) override;
  void emergency_stop() override;
  void reset() override;
  void step() override;
  void obstruct(const Pose2& pose) override;

 private:
  PioneerConfig config_;
  Random sensing_;
  Encoders encoders_;
  Twist2 wanted_;
  double wanted_age_ = 0.0;
};

}  // namespace usher::world
