#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

#include "foundation/geometry/pose2.hpp"

namespace usher::p3dx {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// What the base is able to do. The numbers are those of BaseStatus on the wire.
enum class Mode : std::uint8_t {
  kDisconnected = 0,
  kStandby = 1,    ///< connected, motors off
  kReady = 2,      ///< obeys commands
  kEmergency = 3,  ///< stopped by emergency stop, until reset
};

/// The ring of sonars as slots of 20 deg from the right (-90 deg) to the left: six look ahead, one
/// to each side; nothing looks to 70 deg.
inline constexpr std::size_t kSonarSlots = 10;
inline constexpr double kSonarSpacing = geometry::kPi / 9.0;  // [rad]
inline constexpr bool is_sonar(std::size_t slot) { return slot != 1 && slot != 8; }

/// One report of the base, however it was obtained.
struct Feedback {
  Time stamp{};  ///< on the host's clock
  Mode mode = Mode::kStandby;
  geometry::Pose2 pose;    ///< of base_footprint in odom; begins at zero, never jumps
  geometry::Twist2 twist;  ///< measured
  double battery_percent = std::numeric_limits<double>::quiet_NaN();  ///< {0..100, NaN unknown}
  /// [m] as measured; +infinity: no echo, NaN: no sonar there, or it has not fired since the last
  /// report.
  std::array<float, kSonarSlots> sonar{};
};

}  // namespace usher::p3dx
