#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>

namespace usher::estimation {

/// The median of the last measurements of one range sensor: one echo alone, another sensor's, is
/// not believed. Infinity (no echo) counts as the longest range, NaN (fault) counts not at all;
/// with none left the result is NaN. Of an even number the nearer middle one is taken: too near is
/// the safe error. After a gap of more than `kGap` it begins anew.
class MedianFilter {
 public:
  using Stamp = std::chrono::nanoseconds;  ///< since the epoch of the host

  static constexpr std::size_t kLongest = 15;
  static constexpr Stamp kGap = std::chrono::milliseconds(450);

  struct Median {
    float range = 0.0F;  ///< [m]
    Stamp stamp{};       ///< of the middle measurement: at a steady speed that one is the median
  };

  explicit MedianFilter(std::size_t window = 3) : window_(window) {
    assert(window >= 1 && window <= kLongest);
  }

  /// `stamp` never goes back.
  Median update(float range, Stamp stamp) {
    if (filled_ > 0 && stamp - back(0).stamp > kGap) filled_ = 0;
    ring_[next_] = {range, stamp};
    next_ = (next_ + 1) % window_;
    filled_ = std::min(filled_ + 1, window_);
    return {median(), back((filled_ - 1) / 2).stamp};
  }

 private:
  /// i = 0 is the newest.
  const Median& back(std::size_t i) const { return ring_[(next_ + window_ - 1 - i) % window_]; }

  float median() const {
    std::array<float, kLongest> sorted{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < filled_; ++i) {
      const float range = back(i).range;
      if (std::isnan(range)) continue;
      std::size_t place = count++;
      for (; place > 0 && sorted[place - 1] > range; --place) sorted[place] = sorted[place - 1];
      sorted[place] = range;
    }
    return count == 0 ? std::numeric_limits<float>::quiet_NaN() : sorted[(count - 1) / 2];
  }

  std::size_t window_;
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
  std::array<Median, kLongest> ring_{};
};

}  // namespace usher::estimation
