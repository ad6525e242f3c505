#pragma once

#include <chrono>
#include <cstdint>

namespace usher::runtime {

using Duration = std::chrono::nanoseconds;

/// The clock of a host: monotonic, plus one anchor that the launcher fixed for all components of
/// the host, so that stamps look like wall time and never jump. It has no now(): time is asked of
/// the Host.
struct HostClock {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<HostClock, Duration>;
  static constexpr bool is_steady = true;
};
using Time = HostClock::time_point;

constexpr double seconds(Duration d) { return std::chrono::duration<double>(d).count(); }
/// The nearest nanosecond; |s| must stay below 292 years.
constexpr Duration from_seconds(double s) {
  return Duration(static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

}  // namespace usher::runtime
