#pragma once

#include <chrono>
#include <cstdint>
#include <limits>

namespace usher::segway_rmp {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// Silent for so long, the driver is overruled by its guard, where no parameter says otherwise.
inline constexpr Time kGuardSilence = std::chrono::milliseconds(100);

/// What the base is able to do. The numbers are those of BaseStatus on the wire.
enum class Mode : std::uint8_t {
  kDisconnected = 0,
  kStandby = 1,    ///< powered, motors off or not balancing
  kBalancing = 2,  ///< obeys commands
  kEmergency = 3,  ///< motors off after an emergency stop, until reset
};

/// One control cycle of the base, however it was obtained.
struct SegwayFeedback {
  Time stamp{};  ///< on the host's clock
  Mode mode = Mode::kStandby;
  double pitch = 0.0;           ///< [rad] positive leans forward
  double pitch_rate = 0.0;      ///< [rad/s]
  double roll = 0.0;            ///< [rad]
  double roll_rate = 0.0;       ///< [rad/s]
  double yaw_rate = 0.0;        ///< [rad/s] as the base says; some drivers negate it
  double left_velocity = 0.0;   ///< [m/s] of the wheel, relative to the body
  double right_velocity = 0.0;  ///< [m/s]
  /// [m] Of the odometers, relative to the body: a base that leans forward over standing wheels
  /// counts backward. The first is the base's own count; from there on they never jump or wrap.
  double left_travel = 0.0;
  double right_travel = 0.0;
  double left_torque = 0.0;                                           ///< [Nm]
  double right_torque = 0.0;                                          ///< [Nm]
  double battery_percent = std::numeric_limits<double>::quiet_NaN();  ///< {0..100, NaN unknown}
  std::uint16_t status_1 = 0;  ///< status words, see status.hpp; 0 where there are none
  std::uint16_t status_2 = 0;
};

}  // namespace usher::segway_rmp
