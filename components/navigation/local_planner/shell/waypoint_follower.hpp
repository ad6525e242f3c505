#pragma once

#include <memory>
#include <string>

#include "navigation/local_planner/core/waypoint_follower.hpp"
#include "navigation/local_planner/shell/follower.hpp"

namespace usher::local_planner {

/// Follows the path from waypoint to waypoint, as the meeting report's robot does; takes the place
/// of the local planner where the manifest says so.
class WaypointFollowerComponent final : public FollowerComponent {
 public:
  explicit WaypointFollowerComponent(runtime::Host& host);

 private:
  WaypointFollowerComponent(runtime::Host& host, const WaypointFollowerConfig& config);
  WaypointFollowerComponent(runtime::Host& host, std::shared_ptr<WaypointFollower> follower,
                            const DynamicWindowConfig& motion);
  std::string not_ready() override;
  void take_scan(const sensor_msgs::msg::LaserScan& scan);

  std::shared_ptr<WaypointFollower> follower_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
};

}  // namespace usher::local_planner
