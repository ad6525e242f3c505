#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace usher::kinect {

using Time = std::chrono::nanoseconds;  ///< since the epoch of the host

/// What the clock of a Kinect v1 showed when the last packet of an image left it: it counts 60 MHz
/// in 32 bits, which wrap after 71.6 s, and is one for depth and color (libfreenect: src/cameras.c;
/// unit and wrap: pull request 465; one clock: issue 681).
struct Stamps {
  std::uint32_t depth = 0;
  std::uint32_t color = 0;
};

/// Puts the device's clock on the host's. libfreenect delivers the newest image, which may have
/// waited for its reader since it came (wrappers/c_sync); so the shortest way seen lately is
/// followed, and neither that wait nor the jitter of scheduling shakes the stamps.
class DeviceClock {
 public:
  /// When the depths came, on the host's clock: not after `arrival`, when both images of the pair
  /// were there. A color that is more than 0.1 s ahead of its depths does not count. A clock that
  /// goes back, or is off by more than 1 s, is taken for one that started anew: nothing is known
  /// of its way yet.
  Time stamp(const Stamps& stamps, Time arrival);
  void reset() { offset_.reset(); }

 private:
  std::optional<Time> offset_;  ///< host time minus unwrapped device time
  std::int64_t ticks_ = 0;      ///< unwrapped, of the newest image
  std::uint32_t newest_ = 0;
};

}  // namespace usher::kinect
