#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

namespace usher::sensor_board {

/// The median of the last measurements of one range sensor. Infinity (no echo) counts as the
/// longest range, NaN (fault) counts not at all; with none left the result is NaN. Of an even
/// number the nearer middle one is taken: too near is the safe error.
class MedianFilter {
 public:
  static constexpr std::size_t kLongest = 15;

  explicit MedianFilter(std::size_t window = 3) : window_(window) {
    assert(window >= 1 && window <= kLongest);
  }

  float update(float range) {
    ring_[next_] = range;
    next_ = (next_ + 1) % window_;
    filled_ = std::min(filled_ + 1, window_);
    std::array<float, kLongest> sorted{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < filled_; ++i) {
      const float value = ring_[i];
      if (std::isnan(value)) continue;
      std::size_t place = count++;
      for (; place > 0 && sorted[place - 1] > value; --place) sorted[place] = sorted[place - 1];
      sorted[place] = value;
    }
    if (count == 0) return std::numeric_limits<float>::quiet_NaN();
    return sorted[(count - 1) / 2];
  }

  void reset() { filled_ = next_ = 0; }

 private:
  std::size_t window_;
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
  std::array<float, kLongest> ring_{};
};

}  // namespace usher::sensor_board
