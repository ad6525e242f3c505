#pragma once

#include <ctime>

#include "runtime/api/time.hpp"

namespace usher::runtime {

/// CLOCK_MONOTONIC plus the anchor that the launcher fixed for all components of the host.
class MonotonicClock {
 public:
  /// `anchor` in nanoseconds; 0 = none was given: the difference to the wall clock now.
  explicit MonotonicClock(std::int64_t anchor)
      : anchor_(anchor != 0 ? Duration(anchor) : read(CLOCK_REALTIME) - read(CLOCK_MONOTONIC)) {}

  Time now() const { return Time(read(CLOCK_MONOTONIC) + anchor_); }

  static Duration read(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return std::chrono::seconds(time.tv_sec) + Duration(time.tv_nsec);
  }

 private:
  Duration anchor_;
};

}  // namespace usher::runtime
