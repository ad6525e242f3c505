#include "operations/people_study/scoring.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace usher::people_study {

namespace {
constexpr double kSame = 0.5;  // [m]
}

Score& Score::operator+=(const Score& other) {
  found += other.found;
  missed += other.missed;
  false_alarms += other.false_alarms;
  error += other.error;
  return *this;
}

Score judge(std::span<const people_detector::Sighting> findings, std::span<const Truth> truths,
            double farthest) {
  struct Pair {
    double distance;
    std::size_t finding, truth;
  };
  std::vector<Pair> pairs;
  for (std::size_t f = 0; f < findings.size(); ++f) {
    for (std::size_t t = 0; t < truths.size(); ++t) {
      const double distance =
          std::hypot(findings[f].forward - truths[t].forward, findings[f].left - truths[t].left);
      if (truths[t].area > 0.0 && distance <= kSame) pairs.push_back({distance, f, t});
    }
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  const auto wanted = [&](const Truth& truth) {
    return truth.area >= kVisible && truth.forward >= 0.5 && truth.forward <= farthest;
  };
  std::vector<bool> finding_used(findings.size()), truth_used(truths.size());
  Score score;
  for (const Pair& pair : pairs) {
    if (finding_used[pair.finding] || truth_used[pair.truth]) continue;
    finding_used[pair.finding] = truth_used[pair.truth] = true;
    if (!wanted(truths[pair.truth])) continue;
    ++score.found;
    score.error += pair.distance;
  }
  for (std::size_t t = 0; t < truths.size(); ++t)
    score.missed += wanted(truths[t]) && !truth_used[t];
  score.false_alarms =
      static_cast<int>(std::count(finding_used.begin(), finding_used.end(), false));
  return score;
}

}  // namespace usher::people_study
