#include "tasks/meeting/core/people.hpp"

#include <algorithm>

namespace usher::meeting {

void People::forget() {
  alone_.clear();
  remembered_.clear();
}

void People::leave_alone(const Point2& at, double radius, Time until, Time now) {
  std::erase_if(alone_, [&](const Spot& spot) { return spot.until <= now; });
  if (alone_.size() == kMost) alone_.erase(alone_.begin());
  alone_.push_back({at, radius, until});
}

bool People::left_alone(const Point2& at, Time now) const {
  return std::any_of(alone_.begin(), alone_.end(), [&](const Spot& spot) {
    return now < spot.until && (spot.at - at).norm() < spot.radius;
  });
}

void People::remember(const Point2& at, double radius) {
  const bool known = std::any_of(remembered_.begin(), remembered_.end(),
                                 [&](const Point2& other) { return (other - at).norm() < radius; });
  if (known) return;
  if (remembered_.size() == kMost) remembered_.erase(remembered_.begin());
  remembered_.push_back(at);
}

void People::forget_near(const Point2& at, double radius) {
  std::erase_if(remembered_, [&](const Point2& other) { return (other - at).norm() < radius; });
}

}  // namespace usher::meeting
