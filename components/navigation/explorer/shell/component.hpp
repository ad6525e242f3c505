#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "navigation/explorer/core/explorer.hpp"
#include "runtime/api/host.hpp"
#include "wire/repeater.hpp"
#include "wire/transform_input.hpp"

namespace usher::explorer {

/// Has the navigator drive from viewpoint to viewpoint, and tells what the camera has seen.
class ExplorerComponent final : public runtime::Component {
 public:
  explicit ExplorerComponent(runtime::Host& host);

 private:
  static ExplorerConfig read_parameters(runtime::Host& host);
  static Explorer make(runtime::Host& host);
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_goal(const usher_msgs::msg::ExploreGoal& goal);
  void take_share(const usher_msgs::msg::ExploreShare& share);
  void take_look(const usher_msgs::msg::FleetLook& look);
  void tell_fleet(const Pose2& robot);
  void take_navigation(const usher_msgs::msg::NavigateStatus& status);
  std::optional<Pose2> pose() const;
  void tick();
  void step();
  void publish_status();
  void publish_coverage();

  runtime::Host& host_;
  Explorer core_;
  std::uint64_t& rejected_;
  int ticks_ = 0;
  std::size_t published_cells_ = 0;  ///< seen ones, in the coverage that viewers have
  std::string map_refused_;
  GoalState told_ = GoalState::kIdle;

  wire::TransformInput transforms_;
  wire::Repeater<usher_msgs::msg::NavigateGoal> drives_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<usher_msgs::msg::ExploreGoal> goal_;
  runtime::Input<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigation_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Output<usher_msgs::msg::GoalCancel> cancel_drive_;
  runtime::Output<usher_msgs::msg::ExploreStatus> status_;
  runtime::Output<nav_msgs::msg::OccupancyGrid> coverage_;
  runtime::Output<usher_msgs::msg::FleetLook> looks_;
  runtime::Timer timer_;
};

}  // namespace usher::explorer
