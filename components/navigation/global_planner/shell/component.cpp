#include "navigation/global_planner/shell/component.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::global_planner {

namespace {
using runtime::HealthState;
constexpr auto kCostsAge = std::chrono::seconds(3);
}  // namespace

GridPlannerConfig GlobalPlannerComponent::read_parameters(runtime::Parameters& parameters) {
  GridPlannerConfig config;
  config.cost_factor = 2.0;  // what stands in the way now (252) costs as much as eleven times its
                             // width of free floor
  config.algorithm = parameters.choice("algorithm", {"dijkstra", "astar"}, "dijkstra",
                                       "How the path is searched.") == "astar"
                         ? Algorithm::kAstar
                         : Algorithm::kDijkstra;
  config.metric =
      parameters.choice("metric", {"inflated", "shortest"}, "inflated",
                        "What a path costs: length and nearness of obstacles, or length alone.") ==
              "shortest"
          ? Metric::kShortest
          : Metric::kInflated;
  config.neutral_cost =
      parameters.number("neutral_cost", "-", {1, 1000}, config.neutral_cost, "Cost of free floor.");
  config.cost_factor = parameters.number("cost_factor", "-", {0, 200}, config.cost_factor,
                                         "Weight of the costmap's costs.");
  config.allow_unknown = parameters.flag("allow_unknown", config.allow_unknown,
                                         "Plan through cells that were never seen.");
  config.escape_radius =
      parameters.number("escape_radius", "m", {0, 5}, config.escape_radius,
                        "How far to look for a free cell when the start is blocked.");
  config.goal_tolerance = parameters.number("goal_tolerance", "m", {0, 5}, config.goal_tolerance,
                                            "How far from a blocked goal the path may end.");
  return config;
}

GlobalPlannerComponent::GlobalPlannerComponent(runtime::Host& host)
    : host_(host),
      rejected_costs_(host.health().counter("costs: rejected")),
      plans_(host.health().counter("plans")),
      failures_(host.health().counter("plans: failed")) {
  auto planner = GridPlanner::create(read_parameters(host.parameters()));
  if (!planner) host.fault(planner.error());
  planner_.emplace(std::move(planner).value());

  map_costs_ = host.input(
      topics::kGlobalCosts, {.max_age = kCostsAge, .on_loss = "answers requests with a failure"},
      [this](const auto& message, const auto&) { take_costs(message); },
      [this] { host_.health().set(HealthState::kDegraded, "no global costs"); });
  request_ = host.input(topics::kPlanRequest, {.optional = true},
                        [this](const auto& request, const auto&) { answer(request); });
  reply_ = host.output(topics::kPlanReply);
  view_ = host.output(topics::kPlan);
}

void GlobalPlannerComponent::take_costs(const usher_msgs::msg::Costmap& message) {
  auto costs = wire::from_message(message);
  if (costs && message.header().frame_id() != frames::kMap)
    costs = Error{"expected the frame map, got '" + message.header().frame_id() + "'"};
  if (!costs) {
    ++rejected_costs_;
    host_.health().set(HealthState::kDegraded, "global costs refused: " + costs.error());
    return;
  }
  costs_ = std::move(costs).value();
  host_.health().set(HealthState::kOk);
}

void GlobalPlannerComponent::answer(const usher_msgs::msg::PlanRequest& request) {
  const bool repeated =
      request.id() != 0 && request.id() == last_reply_.id() && request.client() == last_client_;
  if (!repeated) {
    last_reply_ = plan(request);
    last_client_ = request.client();
    ++plans_;
    if (last_reply_.state() == usher_msgs::msg::GoalStatus_Constants::STATE_FAILED) ++failures_;
    view_.publish(last_reply_.path());
  }
  reply_.publish(last_reply_);
}

usher_msgs::msg::PlanReply GlobalPlannerComponent::plan(
    const usher_msgs::msg::PlanRequest& request) {
  using namespace usher_msgs::msg::GoalStatus_Constants;
  usher_msgs::msg::PlanReply reply;
  reply.id(request.id());
  reply.state(STATE_FAILED);
  reply.path(wire::to_message(host_.now(), frames::kMap, std::span<const geometry::Pose2>()));
  const auto start = wire::to_planar(request.start().pose());
  const auto goal = wire::to_planar(request.goal().pose());
  if (!map_costs_.fresh() || !costs_) {
    reply.reason("no global costs");
  } else if (!start || !goal) {
    reply.reason("start or goal is no pose: " + (start ? goal.error() : start.error()));
  } else if (request.start().header().frame_id() != frames::kMap ||
             request.goal().header().frame_id() != frames::kMap) {
    reply.reason("start and goal must be in the frame map");
  } else {
    const Plan& plan = planner_->plan(*costs_, *start, *goal);
    reply.reason(plan.reason);
    if (plan.ok()) {
      reply.state(STATE_SUCCEEDED);
      reply.path(wire::to_message(host_.now(), frames::kMap, plan.path));
      reply.length(static_cast<float>(plan.length));
    }
  }
  return reply;
}

}  // namespace usher::global_planner
