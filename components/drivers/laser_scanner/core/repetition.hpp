#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/laser_scanner/core/scan.hpp"

namespace usher::laser_scanner {

/// Finds a scanner that tells the same turn again and again, as one does whose measuring part hangs
/// while its line lives. Every range is noisy by more than its step, so that two turns of many
/// echoes are never equal; turns with few may be.
class Repetition {
 public:
  static constexpr int kMost = 4;     ///< equal turns after the first one
  static constexpr int kFewest = 50;  ///< echoes that are never equal by chance

  /// The newest turn.
  void take(const Scan& scan) {
    const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    const auto echoes = std::count_if(scan.ranges.begin(), scan.ranges.end(),
                                      [](float range) { return std::isfinite(range); });
    const bool equal = echoes >= kFewest && std::equal(scan.ranges.begin(), scan.ranges.end(),
                                                       last_.begin(), last_.end(), same);
    count_ = equal ? std::min(count_ + 1, kMost) : 0;
    if (!equal) last_ = scan.ranges;
  }
  bool repeats() const { return count_ >= kMost; }

 private:
  std::vector<float> last_;
  int count_ = 0;
};

}  // namespace usher::laser_scanner
