#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "navigation/global_planner/core/grid_planner.hpp"
#include "runtime/api/host.hpp"

namespace usher::global_planner {

/// Answers requests for a path over the global costs.
class GlobalPlannerComponent final : public runtime::Component {
 public:
  explicit GlobalPlannerComponent(runtime::Host& host);

 private:
  static GridPlannerConfig read_parameters(runtime::Parameters& parameters);
  void take_costs(const usher_msgs::msg::Costmap& message);
  void answer(const usher_msgs::msg::PlanRequest& request);
  usher_msgs::msg::PlanReply plan(const usher_msgs::msg::PlanRequest& request);

  runtime::Host& host_;
  std::optional<GridPlanner> planner_;
  std::optional<CostGrid> costs_;
  usher_msgs::msg::PlanReply last_reply_;
  std::string last_client_;  ///< who was given it
  std::uint64_t& rejected_costs_;
  std::uint64_t& plans_;
  std::uint64_t& failures_;

  runtime::Input<usher_msgs::msg::Costmap> map_costs_;
  runtime::Input<usher_msgs::msg::PlanRequest> request_;
  runtime::Output<usher_msgs::msg::PlanReply> reply_;
  runtime::Output<nav_msgs::msg::Path> view_;
};

}  // namespace usher::global_planner
