#include "operations/people_study/tracking_judge.hpp"

#include <algorithm>

namespace usher::people_study {

TrackingJudge::Figures& TrackingJudge::Figures::operator+=(const Figures& other) {
  truths += other.truths;
  misses += other.misses;
  false_alarms += other.false_alarms;
  switches += other.switches;
  away_switches += other.away_switches;
  error += other.error;
  return *this;
}

/// Those who are told as before first, then the nearest pairs of the others. Who is hidden takes no
/// new identity from somebody who is not.
void TrackingJudge::match(std::span<const Truth> truths, std::span<const Told> told) {
  used_.assign(told.size(), 0);
  matches_.assign(truths.size(), told.size());
  const auto away = [&](std::size_t i, std::size_t k) {
    return (told[k].place - truths[i].place).norm();
  };
  for (std::size_t i = 0; i < truths.size(); ++i) {
    for (std::size_t k = 0; k < told.size(); ++k) {
      if (people_[i].identity != told[k].id || used_[k] || away(i, k) > kSame) continue;
      matches_[i] = k, used_[k] = 1;
    }
  }
  struct Pair {
    double away;
    std::size_t person, told;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (!truths[i].visible || matches_[i] < told.size()) continue;
    for (std::size_t k = 0; k < told.size(); ++k)
      if (!used_[k] && away(i, k) <= kSame) pairs.push_back({away(i, k), i, k});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.away < b.away; });
  for (const Pair& pair : pairs) {
    if (matches_[pair.person] < told.size() || used_[pair.told]) continue;
    matches_[pair.person] = pair.told, used_[pair.told] = 1;
  }
}

void TrackingJudge::take(std::span<const Truth> truths, std::span<const Told> told) {
  people_.resize(truths.size());
  match(truths, told);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    Person& person = people_[i];
    const bool is_told = matches_[i] < told.size();
    person.now = is_told ? told[matches_[i]].id : 0;
    person.was_away = person.was_away || !truths[i].in_view;
    if (!truths[i].visible) continue;
    Figures one{.truths = 1};
    if (is_told) {
      one.error = (told[matches_[i]].place - truths[i].place).norm();
      one.switches = person.identity != 0 && person.identity != person.now;
      one.away_switches = one.switches != 0 && person.was_away;
      person.identity = person.now;
      person.was_away = false;
    } else {
      one.misses = 1;
    }
    person.figures += one;
    all_ += one;
  }
  for (std::size_t k = 0; k < told.size(); ++k) {
    if (used_[k] || !told[k].seen) continue;
    all_.false_alarms += std::none_of(truths.begin(), truths.end(), [&](const Truth& truth) {
      return (truth.place - told[k].place).norm() <= kSame;
    });
  }
}

}  // namespace usher::people_study
