#pragma once

#include <chrono>
#include <cstdint>

#include "foundation/estimation/device_clock.hpp"

namespace usher::kinect {

using Time = std::chrono::nanoseconds;  ///< since the epoch of the host

/// What the clock of a Kinect v1 showed when the last packet of an image left it: it is one for
/// depth and color (libfreenect: src/cameras.c; one clock: issue 681).
struct Stamps {
  std::uint32_t depth = 0;
  std::uint32_t color = 0;
};

/// It counts 60 MHz in 32 bits, which wrap after 71.6 s (libfreenect: pull request 465).
inline constexpr estimation::DeviceClock::Counter kCounter{.bits = 32,
                                                           .ticks = 60,
                                                           .last = std::chrono::microseconds(1),
                                                           .restart = std::chrono::seconds(1)};

/// When the depths came, on the host's clock: not after `arrival`, when both images of the pair
/// were there. libfreenect delivers the newest image, which may have waited for its reader since it
/// came (wrappers/c_sync). A color that is more than 0.1 s ahead of its depths does not count.
inline Time came_at(const Stamps& stamps, Time arrival, estimation::DeviceClock& clock) {
  constexpr Time kApart = std::chrono::milliseconds(100);
  const Time ahead = clock.time_of(clock.step(stamps.depth, stamps.color));
  if (ahead <= Time::zero() || ahead > kApart) return clock.stamp(stamps.depth, arrival);
  return clock.stamp(stamps.color, arrival) - ahead;
}

}  // namespace usher::kinect
