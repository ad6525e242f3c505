#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace usher::operations {

/// How a depth pipeline's scans compare with what is really there. What they do not know (NaN)
/// where something is counts against them.
struct ScanJudgement {
  static constexpr double kReach = 4.0;   ///< [m] within which scans are judged
  static constexpr double kWrong = 0.25;  ///< [m] of range

  int obstacles = 0;           ///< bearings with something within reach
  int missed = 0;              ///< of them, seen farther or as free
  int unknown = 0;             ///< of them, told as not known: nothing is marked there
  int free = 0;                ///< bearings without
  int false_ones = 0;          ///< seen nearer than anything is
  std::vector<double> errors;  ///< [m] of the others

  /// Ranges [m] of the same bearings; infinity: nothing there.
  void take(const std::vector<float>& truth, const std::vector<float>& seen) {
    for (std::size_t i = 2; i + 2 < truth.size(); ++i) {
      const bool there = static_cast<double>(truth[i]) < kReach;
      if (std::isnan(seen[i])) {
        obstacles += there;
        unknown += there;
        continue;
      }
      // A neighbour's edge is no error.
      float near = truth[i], far = truth[i];
      for (std::size_t k = i - 2; k <= i + 2; ++k)
        near = std::min(near, truth[k]), far = std::max(far, truth[k]);
      const auto range = static_cast<double>(seen[i]);
      there ? ++obstacles : ++free;
      if (range < static_cast<double>(near) - kWrong) {
        ++false_ones;
      } else if (there && range > static_cast<double>(far) + kWrong) {
        ++missed;
      } else if (there) {
        errors.push_back(std::abs(
            range - std::clamp(range, static_cast<double>(near), static_cast<double>(far))));
      }
    }
  }
  double missed_share() const {
    return obstacles > 0 ? static_cast<double>(missed) / obstacles : 0;
  }
  double unknown_share() const {
    return obstacles > 0 ? static_cast<double>(unknown) / obstacles : 0;
  }
  double false_share() const {
    const int all = obstacles - unknown + free;
    return all > 0 ? static_cast<double>(false_ones) / all : 0;
  }
  double error(double quantile) {
    if (errors.empty()) return 0.0;
    const auto at =
        static_cast<std::ptrdiff_t>(quantile * (static_cast<double>(errors.size()) - 1));
    std::nth_element(errors.begin(), errors.begin() + at, errors.end());
    return errors[static_cast<std::size_t>(at)];
  }
};

}  // namespace usher::operations
