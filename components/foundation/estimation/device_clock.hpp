#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace usher::estimation {

/// Puts a device's clock on the host's. What the device says arrives late by the way and by the
/// wait for its reader, which shakes; so the shortest way seen lately is followed, which may grow
/// by 200 ppm of the time that passes, more than two quartzes drift apart.
class DeviceClock {
 public:
  using Time = std::chrono::nanoseconds;  ///< since any epoch of the host

  /// What the device counts. The time between two stamps must stay below half of what it counts
  /// until it wraps, else it is not known.
  struct Counter {
    int bits = 32;                ///< {2..32} it wraps after 2^bits ticks
    std::int64_t ticks = 1;       ///< {> 0} so many of them
    Time last{1000};              ///< {> 0} ... last so long
    Time restart{1'000'000'000};  ///< {> 0} off by more than this, the device has started anew
  };

  explicit DeviceClock(const Counter& counter) : counter_(counter) {}

  /// [host] When the device counted `raw`, which it said in what came at `arrival`: never later. A
  /// counter that went back is of a device that started anew: nothing is known of its way yet.
  Time stamp(std::uint32_t raw, Time arrival);
  void reset() { offset_.reset(); }

  /// How long so many ticks last.
  Time time_of(std::int64_t ticks) const { return ticks * counter_.last / counter_.ticks; }
  /// [ticks] from `from` to `to`, the shorter way round.
  std::int64_t step(std::uint32_t from, std::uint32_t to) const;

 private:
  Counter counter_;
  std::optional<Time> offset_;  ///< host's time minus the device's, unwrapped
  std::int64_t ticks_ = 0;      ///< unwrapped
  std::uint32_t raw_ = 0;
};

}  // namespace usher::estimation
