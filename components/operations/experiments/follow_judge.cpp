#include "operations/experiments/follow_judge.hpp"

#include <algorithm>

namespace usher::operations {

void FollowJudge::take(const FollowMoment& moment) {
  const bool waited = last_ && last_->waits;
  if (moment.waits && last_) waited_ += moment.t - last_->t;
  if (!moment.waits) largest_gap_ = std::max(largest_gap_, moment.gap);
  if (moment.drives) largest_gap_driving_ = std::max(largest_gap_driving_, moment.gap);
  const bool lost = moment.gap > kFar || !moment.visible;
  if (moment.waits && !waited) {
    ++waits_;
    if (!lost && moment.gap < kNear) ++needless_waits_;
  }
  last_ = moment;
  if (!lost) {
    finish();
    return;
  }
  if (!lost_since_) {
    lost_since_ = moment.t;
    noticed_ = false;
  }
  if (moment.waits && !noticed_) {
    noticed_ = true;
    losses_.push_back(moment.t - *lost_since_);
  }
}

void FollowJudge::finish() {
  if (lost_since_ && !noticed_ && last_->t - *lost_since_ > kShort)
    losses_.push_back(last_->t - *lost_since_);
  lost_since_.reset();
}

}  // namespace usher::operations
