#include "drivers/kinect/core/device_clock.hpp"

#include <algorithm>

namespace usher::kinect {

namespace {

constexpr std::int32_t kApart = 6'000'000;  // [1/60 us] 0.1 s
constexpr Time kRestart = std::chrono::seconds(1);
constexpr int kDrift = 5000;  // 200 ppm, more than two quartzes drift apart

constexpr Time time_of(std::int64_t ticks) { return Time(ticks * 50 / 3); }

}  // namespace

Time DeviceClock::stamp(const Stamps& stamps, Time arrival) {
  // The difference of two wrapping counters is exact as long as it is below half their range.
  const auto ahead = static_cast<std::int32_t>(stamps.color - stamps.depth);
  const std::int32_t waited = ahead > 0 && ahead <= kApart ? ahead : 0;
  const std::uint32_t newest = stamps.depth + static_cast<std::uint32_t>(waited);
  const auto step = static_cast<std::int32_t>(newest - newest_);
  std::int64_t ticks = ticks_ + step;
  if (offset_ && (step < 0 || std::chrono::abs(arrival - time_of(ticks) - *offset_) > kRestart))
    offset_.reset();
  if (!offset_) ticks = newest;
  const Time offset = arrival - time_of(ticks);
  offset_ = offset_ ? std::min(offset, *offset_ + time_of(ticks - ticks_) / kDrift) : offset;
  ticks_ = ticks;
  newest_ = newest;
  return time_of(ticks - waited) + *offset_;
}

}  // namespace usher::kinect
