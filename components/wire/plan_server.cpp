#include "wire/plan_server.hpp"

#include <span>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::wire {

PlanServer::PlanServer(runtime::Host& host, Planner planner)
    : host_(host),
      planner_(std::move(planner)),
      plans_(host.health().counter("plans")),
      failures_(host.health().counter("plans: failed")) {
  request_ = host.input(topics::kPlanRequest, {.optional = true},
                        [this](const auto& request, const auto&) { answer(request); });
  reply_ = host.output(topics::kPlanReply);
  view_ = host.output(topics::kPlan);
}

void PlanServer::answer(const usher_msgs::msg::PlanRequest& request) {
  using namespace usher_msgs::msg::GoalStatus_Constants;
  const bool repeated =
      request.id() != 0 && request.id() == last_reply_.id() && request.client() == last_client_;
  if (!repeated) {
    const auto found = plan(request);
    last_client_ = request.client();
    last_reply_ = {};
    last_reply_.id(request.id());
    last_reply_.state(found ? STATE_SUCCEEDED : STATE_FAILED);
    const auto poses = found ? std::span(found->poses) : std::span<const geometry::Pose2>();
    last_reply_.path(to_message(host_.now(), frames::kMap, poses));
    if (found) last_reply_.length(static_cast<float>(found->length));
    if (!found) last_reply_.reason(found.error());
    ++plans_;
    if (!found) ++failures_;
    view_.publish(last_reply_.path());
  }
  reply_.publish(last_reply_);
}

Result<PlannedPath> PlanServer::plan(const usher_msgs::msg::PlanRequest& request) const {
  const auto start = to_planar(request.start().pose());
  const auto goal = to_planar(request.goal().pose());
  if (!start || !goal)
    return Error{"start or goal is no pose: " + (start ? goal.error() : start.error())};
  if (request.start().header().frame_id() != frames::kMap ||
      request.goal().header().frame_id() != frames::kMap)
    return Error{"start and goal must be in the frame map"};
  return planner_(*start, *goal);
}

}  // namespace usher::wire
