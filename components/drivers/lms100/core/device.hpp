#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace usher::lms100 {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// One turn of a laser scanner, however it was obtained. Angles in the scanner's frame: x straight
/// ahead, counter-clockwise seen from above.
struct Scan {
  Time stamp{};                  ///< of the measurement, on the host's clock
  double angle_min = 0.0;        ///< [rad] of the first beam
  double angle_increment = 0.0;  ///< [rad] from beam to beam, positive
  double scan_time = 0.0;        ///< [s] of a whole turn
  double time_increment = 0.0;   ///< [s] from beam to beam
  std::vector<float> ranges;     ///< [m] +infinity: no echo, NaN: dazzled, implausible or filtered
  std::vector<float> intensities;  ///< device units; empty without remission values
  std::uint16_t counter = 0;       ///< of turns; a gap means lost scans
  bool polluted = false;           ///< the device complains about its window
};

}  // namespace usher::lms100
