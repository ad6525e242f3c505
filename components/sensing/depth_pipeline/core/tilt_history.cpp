#include "sensing/depth_pipeline/core/tilt_history.hpp"

#include <algorithm>
#include <cmath>

namespace usher::depth_pipeline {

bool TiltHistory::add(Stamp stamp, double servo) {
  if (!std::isfinite(servo) || (count_ > 0 && stamp <= newest_stamp())) return false;
  readings_[next_] = {stamp, servo};
  next_ = (next_ + 1) % kCapacity;
  count_ = std::min(count_ + 1, kCapacity);
  return true;
}

bool TiltHistory::reaches(Stamp stamp) const {
  return count_ >= 2 && back(count_ - 1).stamp <= stamp;
}

std::optional<double> TiltHistory::at(Stamp stamp) const {
  if (!reaches(stamp)) return std::nullopt;
  std::size_t before = 1;  // the reading before the time, but never the newest
  while (back(before).stamp > stamp) ++before;
  const double after = back(before - 1).servo;
  if (std::abs(after - back(before).servo) > kStill) return std::nullopt;
  return after;
}

bool TiltHistory::turns() const { return count_ >= 2 && !at(newest_stamp()); }

}  // namespace usher::depth_pipeline
