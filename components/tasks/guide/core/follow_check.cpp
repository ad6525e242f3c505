#include "tasks/guide/core/follow_check.hpp"

#include <algorithm>
#include <cmath>

namespace usher::guide {

namespace {

/// [m] from the departure. While it turns there, its cameras sweep over who stands beside it.
constexpr double kLeaves = 0.5;

}  // namespace

void FollowCheck::depart(Time now) {
  departed_ = now;
  departed_from_.reset();
  grace_ = true;
  state_ = Follower::kUnknown;
  lost_ = false;
  unseen_since_.reset();
}

void FollowCheck::await(Time now) {
  state_ = Follower::kAwaited;
  waiting_since_ = called_ = now;
}

void FollowCheck::update(const std::optional<FollowerSighting>& sighting,
                         const std::optional<geometry::Point2>& robot, Time now) {
  if (!departed_from_) departed_from_ = robot;
  const double way = robot ? (*robot - *departed_from_).norm() : kNothing;
  if (way >= limits_.grace_way || now - departed_ >= limits_.grace) grace_ = false;
  if (!sighting && !waits()) {
    state_ = Follower::kUnknown;
    unseen_since_.reset();
    return;
  }
  const bool seen = sighting && sighting->seen && std::isfinite(sighting->gap);
  if (seen) {
    if (sighting->behind && !(way < kLeaves)) grace_ = false;
    gap_ = sighting->gap;
    unseen_since_.reset();
  } else if (!unseen_since_) {
    unseen_since_ = now;
  }
  if (waits()) {
    if (seen && gap_ <= limits_.resume) {
      state_ = Follower::kFollowing;
      return;
    }
    if (now - called_ >= limits_.call) {
      state_ = Follower::kCalled;
      called_ = now;
      ++calls_;
    }
    lost_ = now - waiting_since_ >= limits_.give_up;
    return;
  }
  // A visitor who steps behind the robot passes through places where nobody can see him.
  const bool missed = !seen && now - *unseen_since_ >= limits_.unseen && !grace_;
  if (missed || (seen && gap_ >= limits_.far)) return await(now);
  if (!seen) return;
  state_ = gap_ > limits_.near ? Follower::kLagging : Follower::kFollowing;
}

double FollowCheck::pace(double cap) const {
  if (waits()) return std::min(cap, limits_.slowest);
  if (state_ != Follower::kLagging) return cap;
  const double share = std::clamp((limits_.far - gap_) / (limits_.far - limits_.near), 0.0, 1.0);
  return std::min(cap, limits_.slowest + share * std::max(0.0, cap - limits_.slowest));
}

}  // namespace usher::guide
