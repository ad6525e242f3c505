#include "operations/experiments/errand.hpp"

#include <utility>

namespace usher::operations {

using namespace usher_msgs::msg;

Errand::Errand(std::string location, std::uint64_t first_id, Ways ways)
    : location_(std::move(location)), ways_(std::move(ways)), id_(first_id) {}

void Errand::fail(const std::string& reason) {
  stage_ = Stage::kFailed;
  reason_ = reason;
}

void Errand::take(const SupervisorStatus& status) {
  if ((stage_ != Stage::kStart && stage_ != Stage::kGo) || status.last_request() != id_) return;
  ++id_;
  if (status.last_request_done()) {
    stage_ = stage_ == Stage::kStart ? Stage::kGo : Stage::kGoal;
    steps_ = 0;
    reason_.clear();
  } else {
    reason_ = "the supervisor refused: " + status.last_request_reason();
  }
}

void Errand::take(const NavigateStatus& status) {
  using namespace GoalStatus_Constants;
  if ((stage_ != Stage::kGoal && stage_ != Stage::kDriving) || status.id() != id_) return;
  stage_ = Stage::kDriving;
  reason_ = status.reason();
  switch (status.state()) {
    case STATE_SUCCEEDED:
      stage_ = Stage::kSucceeded;
      break;
    case STATE_FAILED:
      fail(status.reason());
      break;
    case STATE_CANCELLED:
    case STATE_REPLACED:
      fail("somebody else ended it: " + status.reason());
      break;
    default:
      break;
  }
}

void Errand::step() {
  if (over() || stage_ == Stage::kDriving) return;
  if (++steps_ > kPatience) {
    fail(!reason_.empty()         ? reason_
         : stage_ == Stage::kGoal ? "the navigator did not answer"
                                  : "the supervisor did not answer");
    return;
  }
  if (stage_ == Stage::kGoal) {
    NavigateGoal goal;
    goal.id(id_);
    goal.client(kClient);
    goal.location(location_);
    ways_.tell(goal);
    return;
  }
  SupervisorRequest request;
  request.id(id_);
  request.client(kClient);
  request.command(stage_ == Stage::kStart ? SupervisorRequest_Constants::COMMAND_NAVIGATION_START
                                          : SupervisorRequest_Constants::COMMAND_NAVIGATION_GO);
  request.goal(location_);
  ways_.ask(request);
}

Arrival arrival(const Errand& errand, double longest) {
  if (errand.over()) return {errand.succeeded(), errand.reason()};
  return {false, "no end within " + std::to_string(static_cast<int>(longest)) + " s" +
                     (errand.reason().empty() ? "" : ": " + errand.reason())};
}

}  // namespace usher::operations
