#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "navigation/global_planner/core/grid_planner.hpp"
#include "runtime/api/host.hpp"
#include "wire/plan_server.hpp"

namespace usher::global_planner {

/// Answers requests for a path over the global costs.
class GlobalPlannerComponent final : public runtime::Component {
 public:
  explicit GlobalPlannerComponent(runtime::Host& host);

 private:
  static GridPlannerConfig read_parameters(runtime::Parameters& parameters);
  void take_costs(const usher_msgs::msg::Costmap& message);
  Result<wire::PlannedPath> plan(const geometry::Pose2& start, const geometry::Pose2& goal);

  runtime::Host& host_;
  std::optional<GridPlanner> planner_;
  std::optional<CostGrid> costs_;
  std::uint64_t& rejected_costs_;

  runtime::Input<usher_msgs::msg::Costmap> map_costs_;
  std::optional<wire::PlanServer> server_;
};

}  // namespace usher::global_planner
