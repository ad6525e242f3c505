#pragma once

#include <optional>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "navigation/roadmap/core/new_obstacles.hpp"
#include "navigation/roadmap/core/roadmap_planner.hpp"
#include "runtime/api/host.hpp"
#include "wire/plan_server.hpp"

namespace usher::roadmap {

/// Answers requests for a path with a roadmap: takes the place of the grid planner where the
/// manifest says so.
class RoadmapComponent final : public runtime::Component {
 public:
  explicit RoadmapComponent(runtime::Host& host);

 private:
  static RoadmapConfig read_parameters(runtime::Parameters& parameters);
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_costs(const usher_msgs::msg::Costmap& message);
  void take_outcome(const usher_msgs::msg::NavigateStatus& status);
  Result<wire::PlannedPath> plan(const geometry::Pose2& start, const geometry::Pose2& goal);
  void look_for_obstacles(const Point2& robot);

  runtime::Host& host_;
  double forget_distance_;
  double obstacle_tolerance_;
  std::optional<RoadmapPlanner> planner_;
  std::string map_refused_;  ///< why; empty: the newest was taken
  double resolution_ = 0.05;
  grid::DistanceField map_distances_;
  std::optional<grid::Grid<std::uint8_t>> costs_;
  std::vector<Point2> obstacles_;
  std::uint64_t& rejected_;
  std::uint64_t& regenerations_;

  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<usher_msgs::msg::Costmap> map_costs_;
  runtime::Input<usher_msgs::msg::NavigateStatus> outcome_;
  std::optional<wire::PlanServer> server_;
};

}  // namespace usher::roadmap
