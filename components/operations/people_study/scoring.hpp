#pragma once

#include <span>

#include "operations/people_study/scene.hpp"

namespace usher::people_study {

/// How findings agree with the truth.
struct Score {
  int found = 0;   ///< people that must be found, and were
  int missed = 0;  ///< and were not
  int false_alarms = 0;
  double error = 0.0;  ///< [m] sum of the distances of those that were found

  double recall() const { return found + missed > 0 ? double(found) / (found + missed) : 1.0; }
  double precision() const {
    return found + false_alarms > 0 ? double(found) / (found + false_alarms) : 1.0;
  }
  Score& operator+=(const Score& other);
};

/// Pairs findings and truths, the nearest first, at most 0.5 m apart. People who are hardly visible
/// or farther than `farthest` [m] need not be found, and are no false alarm when they are.
Score judge(std::span<const people_detector::Sighting> findings, std::span<const Truth> truths,
            double farthest = 6.0);

}  // namespace usher::people_study
