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
    : host_(host), rejected_costs_(host.health().counter("costs: rejected")) {
  auto planner = GridPlanner::create(read_parameters(host.parameters()));
  if (!planner) host.fault(planner.error());
  planner_.emplace(std::move(planner).value());

  map_costs_ = host.input(
      topics::kGlobalCosts, {.max_age = kCostsAge, .on_loss = "answers requests with a failure"},
      [this](const auto& message, const auto&) { take_costs(message); },
      [this] { host_.health().set(HealthState::kDegraded, "no global costs"); });
  server_.emplace(host, [this](const auto& start, const auto& goal) { return plan(start, goal); });
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

Result<wire::PlannedPath> GlobalPlannerComponent::plan(const geometry::Pose2& start,
                                                       const geometry::Pose2& goal) {
  if (!map_costs_.fresh() || !costs_) return Error{"no global costs"};
  const Plan& plan = planner_->plan(*costs_, start, goal);
  if (!plan.ok()) return Error{plan.reason};
  return wire::PlannedPath{plan.path, plan.length};
}

}  // namespace usher::global_planner
