#include "control/interaction_control/core/pose_motion.hpp"

#include <algorithm>
#include <cmath>

namespace usher::interaction_control {

namespace {

constexpr double kPeak = 1.875;  // of the curve's rate over its mean

double minimum_jerk(double t) { return t * t * t * (10.0 + t * (-15.0 + 6.0 * t)); }

}  // namespace

void PoseMotion::start_at(const kinematics::TorsoPose& pose) {
  start_ = goal_ = wanted_ = pose_ = pose;
  progress_ = 1.0;
  pace_ = 0.0;
}

void PoseMotion::begin() {
  start_ = pose_;
  goal_ = wanted_;
  progress_ = 0.0;
  duration_ = parameters_.shortest;
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i) {
    const double way = std::abs(goal_[i] - start_[i]);
    const double rate = parameters_.pace * parameters_.limits[i].rate;
    if (way > 0.0 && rate > 0.0) duration_ = std::max(duration_, kPeak * way / rate);
  }
}

const kinematics::TorsoPose& PoseMotion::step(double seconds) {
  if (progress_ >= 1.0) pace_ = 0.0;
  if (wanted_ != goal_ && pace_ == 0.0) begin();
  const bool go = !still_ && wanted_ == goal_ && progress_ < 1.0;
  const double change = seconds / parameters_.brake;
  const double before = pace_;
  pace_ = std::clamp(pace_ + (go ? change : -change), 0.0, 1.0);
  progress_ = std::min(1.0, progress_ + 0.5 * (before + pace_) * seconds / duration_);
  const double share = minimum_jerk(progress_);
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i)
    pose_[i] = progress_ >= 1.0 ? goal_[i] : start_[i] + share * (goal_[i] - start_[i]);
  return pose_;
}

}  // namespace usher::interaction_control
