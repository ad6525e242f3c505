#pragma once

#include <chrono>
#include <vector>

namespace usher::laser_scanner {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// One turn of a laser scanner, however it was obtained. Angles in the scanner's frame: x straight
/// ahead, counter-clockwise seen from above.
struct Scan {
  Time stamp{};                    ///< of the first beam, on the host's clock
  double angle_min = 0.0;          ///< [rad] of the first beam
  double angle_increment = 0.0;    ///< [rad] from beam to beam, positive
  double scan_time = 0.0;          ///< [s] of a whole turn
  double time_increment = 0.0;     ///< [s] from beam to beam
  std::vector<float> ranges;       ///< [m] +infinity: no echo, NaN: not measurable or filtered
  std::vector<float> intensities;  ///< device units; empty without remission values
};

}  // namespace usher::laser_scanner
