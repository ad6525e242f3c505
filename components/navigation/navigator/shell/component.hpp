#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "idl/topics.hpp"
#include "navigation/navigator/core/navigator.hpp"
#include "runtime/api/host.hpp"
#include "wire/repeater.hpp"
#include "wire/transform_input.hpp"

namespace usher::navigator {

/// Takes goals, asks the global planner, tells the local planner, says how it goes.
class NavigatorComponent final : public runtime::Component {
 public:
  explicit NavigatorComponent(runtime::Host& host);

 private:
  static NavigatorConfig read_parameters(runtime::Parameters& parameters);
  static Locations read_locations(runtime::Host& host);
  static Navigator make(runtime::Host& host);
  double now() const { return runtime::seconds(host_.now().time_since_epoch()); }
  void take_goal(const usher_msgs::msg::NavigateGoal& goal);
  void take_goal_pose(const geometry_msgs::msg::PoseStamped& goal);
  void take_supervisor(const usher_msgs::msg::SupervisorStatus& status);
  void refuse_viewer(const std::string& reason);
  void watch_viewer();
  void watch_operator();
  void take_reply(const usher_msgs::msg::PlanReply& reply);
  Situation situation();
  std::string not_allowed_because() const;
  bool somebody_ahead() const;
  void step();
  void publish_locations();
  void remember_last_word(const NavigationStatus& status);
  void speak(bool due);
  void publish(const NavigationStatus& status);
  void send_plan(const PlanRequest& request);
  void send_motion(const Motion& motion);

  runtime::Host& host_;
  wire::TransformInput transforms_;
  Navigator core_;
  /// A goal from rviz, for which the supervisor was asked to let the navigation drive.
  struct ViewerGoal {
    std::uint64_t id = 0;
    geometry::Pose2 pose;
    runtime::Time asked;
  };
  std::optional<ViewerGoal> viewer_goal_;
  std::uint64_t clear_requests_ = 0;
  std::deque<NavigationStatus> last_words_;  ///< of goals with an outcome, not published yet
  runtime::Time last_word_at_{};
  std::uint64_t last_id_ = 0;
  GoalState last_state_ = GoalState::kIdle;  ///< of the core, when it was looked at last
  bool unsaid_ = true;                       ///< the core's status has changed since it was said
  bool turn_of_words_ = true;                ///< it was said since the last word
  int status_share_ = 0;
  std::optional<runtime::Time> not_navigating_since_;  ///< though an operator's goal is under way
  std::uint64_t& rejected_;
  double unfelt_trail_;  ///< [m]

  runtime::Input<usher_msgs::msg::NavigateGoal> goal_;
  runtime::Input<geometry_msgs::msg::PoseStamped> goal_pose_;
  runtime::Input<usher_msgs::msg::GoalCancel> cancel_;
  runtime::Input<usher_msgs::msg::NavigatePace> pace_;
  runtime::Input<usher_msgs::msg::PlanReply> reply_;
  runtime::Input<usher_msgs::msg::FollowStatus> follow_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Input<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Input<usher_msgs::msg::People> people_;
  runtime::Output<usher_msgs::msg::PlanRequest> plan_;
  runtime::Output<usher_msgs::msg::FollowGoal> motion_;
  runtime::Output<usher_msgs::msg::CostmapRequest> clear_;
  runtime::Output<usher_msgs::msg::NavigateStatus> status_;
  runtime::Output<usher_msgs::msg::Locations> locations_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  runtime::Timer timer_;
};

}  // namespace usher::navigator
