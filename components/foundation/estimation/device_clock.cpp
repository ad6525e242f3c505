#include "foundation/estimation/device_clock.hpp"

#include <algorithm>

namespace usher::estimation {

namespace {

constexpr int kDrift = 5000;  // one part in

}  // namespace

std::int64_t DeviceClock::step(std::uint32_t from, std::uint32_t to) const {
  const int unused = 32 - counter_.bits;
  const std::uint32_t way = (to - from) << unused;  // so that its sign is the sign of an int32_t
  return static_cast<std::int32_t>(way) >> unused;
}

DeviceClock::Time DeviceClock::stamp(std::uint32_t raw, Time arrival) {
  const std::int64_t passed = step(raw_, raw);
  std::int64_t ticks = ticks_ + passed;
  if (offset_ &&
      (passed < 0 || std::chrono::abs(arrival - time_of(ticks) - *offset_) > counter_.restart))
    offset_.reset();
  if (!offset_) ticks = raw;
  const Time offset = arrival - time_of(ticks);
  offset_ = offset_ ? std::min(offset, *offset_ + time_of(passed) / kDrift) : offset;
  ticks_ = ticks;
  raw_ = raw;
  return time_of(ticks) + *offset_;
}

}  // namespace usher::estimation
