#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace usher::sensor_board {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

inline constexpr std::size_t kSonars = 5;

/// Contact at the four corners of the footprint; true is pressed.
struct Whiskers {
  bool front_left = false;
  bool front_right = false;
  bool back_left = false;
  bool back_right = false;
  bool operator==(const Whiskers&) const = default;
};

/// What the sensors say, however it was obtained.
struct Reading {
  Time stamp{};  ///< on the host's clock
  std::array<float, kSonars>
      ranges{};  ///< [m] right to left, as measured; +infinity: no echo, NaN: sensor fault
  Whiskers whiskers;
  double tilt = 0.0;     ///< [rad] where the tilt servo stands, on its way, too; up is positive
  bool measured = true;  ///< ranges and tilt are of the stamp; else of the reading before
};

}  // namespace usher::sensor_board
