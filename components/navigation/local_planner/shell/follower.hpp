#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "foundation/kinematics/roll_out.hpp"
#include "idl/topics.hpp"
#include "navigation/local_planner/core/dynamic_window.hpp"
#include "runtime/api/host.hpp"
#include "wire/transform_input.hpp"

namespace usher::local_planner {

/// Speeds, limits, tolerances, outline and response of the base: what every follower needs.
DynamicWindowConfig read_motion(runtime::Host& host);

/// Drives along the navigator's path on the local costs; decides whenever new costs arrive. Goals,
/// silences and reports are the same whoever follows the path.
class FollowerComponent : public runtime::Component {
 protected:
  FollowerComponent(runtime::Host& host, std::shared_ptr<PathFollower> follower,
                    const DynamicWindowConfig& motion);

  runtime::Host& host() { return host_; }
  wire::TransformInput& transforms() { return transforms_; }
  /// Counts an input that was refused.
  void reject() { ++rejected_; }
  /// Stands, commands zero and says why.
  void stand(std::uint8_t state, const std::string& reason);
  std::optional<geometry::Twist2> measured() const;

 private:
  /// What the follower misses to drive along a path; empty: nothing.
  virtual std::string not_ready() { return {}; }
  void take_goal(const usher_msgs::msg::FollowGoal& goal);
  void cancel(const usher_msgs::msg::GoalCancel& cancel);
  void forget_goal(const std::string& reason);
  void take_costs(const usher_msgs::msg::Costmap& message, runtime::Time effective);
  /// The command is as old as the costs: `effective`, on this host's clock.
  void decide(const grid::Grid<std::uint8_t>& costs, runtime::Time effective);
  Decision decision(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                    const geometry::Twist2& measured);
  const usher_msgs::msg::People* people_now() const;
  bool people_are_missing() const;
  void place_people(const geometry::Point2& here);
  bool place_path();
  void conclude(const Decision& decision, const geometry::Pose2& pose);
  void publish_status(std::uint8_t state, const std::string& reason, double remaining,
                      double obstacle);

  runtime::Host& host_;
  std::shared_ptr<PathFollower> follower_;
  double default_pace_, slowest_, careful_pace_;
  double pace_;  ///< that the goal asks for
  double back_off_speed_, turn_rate_;
  bool people_needed_;

  std::uint64_t goal_id_ = 0;
  std::string client_;
  std::uint8_t mode_ = 0;
  std::uint8_t state_ = 0;
  double amount_ = 0.0;
  std::optional<geometry::Pose2> recovery_start_;
  double turned_ = 0.0, last_yaw_ = 0.0;
  std::vector<geometry::Pose2> path_in_map_;
  std::optional<geometry::Pose2>
      path_placed_by_;  ///< odom_T_map that the planner's path was placed with

  std::vector<MovingDisc> everybody_;
  geometry::Twist2 last_command_;
  kinematics::RollOut roll_out_;
  runtime::Time last_decision_{};
  std::optional<runtime::Time> blocked_since_;
  std::uint64_t& rejected_;

  wire::TransformInput transforms_;
  runtime::Input<usher_msgs::msg::FollowGoal> goal_;
  runtime::Input<usher_msgs::msg::NavigateStatus> navigator_;
  runtime::Input<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Input<usher_msgs::msg::Costmap> costs_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Input<usher_msgs::msg::People> people_;
  runtime::Output<geometry_msgs::msg::TwistStamped> command_;
  runtime::Output<usher_msgs::msg::FollowStatus> status_;
  runtime::Output<nav_msgs::msg::Path> view_;
};

}  // namespace usher::local_planner
