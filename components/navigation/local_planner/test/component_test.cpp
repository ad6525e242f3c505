#include "navigation/local_planner/shell/component.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "navigation/local_planner/shell/waypoint_follower.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::local_planner {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::FollowGoal_Constants;
using namespace usher_msgs::msg::GoalStatus_Constants;
constexpr const char* kFootprint = "robot.footprint: [0.3, 0.3, -0.3, 0.3, -0.3, -0.3, 0.3, -0.3]";

/// A robot on a free floor whose base does at once what it is told; it stays where it is, so that
/// its path never ends.
class Component : public testing::TestWithParam<const char*> {
 protected:
  void run(int ms, bool navigator = true) {
    for (int at = 0; at < ms; at += 50) {
      tf2_msgs::msg::TFMessage moving;
      moving.transforms().push_back(
          wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint, geometry::Pose3{}));
      moving.transforms().push_back(
          wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::Pose3{}));
      host.publish(topics::kTf, moving);
      tf2_msgs::msg::TFMessage fixed;
      fixed.transforms().push_back(
          wire::transform(host.now(), frames::kBaseFootprint, "laser", geometry::Pose3{}));
      host.publish(topics::kTfStatic, fixed);
      sensor_msgs::msg::LaserScan scan;
      scan.header(wire::header(host.now(), "laser"));
      scan.angle_min(-2.0F), scan.angle_max(2.0F), scan.angle_increment(0.01F);
      scan.range_min(0.05F), scan.range_max(4.0F);
      scan.ranges(std::vector<float>(401, std::numeric_limits<float>::infinity()));
      host.publish(topics::kScanFiltered, scan);
      nav_msgs::msg::Odometry odom;
      odom.header(wire::header(host.now(), frames::kOdom));
      odom.pose().pose(wire::to_message(geometry::Pose2{}));
      odom.twist().twist(wire::to_message(host.now(), commanded()).twist());
      host.publish(topics::kOdom, odom);
      if (navigator) {
        usher_msgs::msg::NavigateStatus status;
        status.header(wire::header(host.now(), frames::kMap));
        host.publish(topics::kNavigateStatus, status);
      }
      host.publish(topics::kLocalCosts, wire::to_message(host.now(), frames::kOdom, costs));
      host.run_for(milliseconds(50));
    }
  }
  void tell(std::uint8_t mode, float amount = 0.0F) {
    ++goal_id;
    repeat(mode, amount, 0.0F);
  }
  void repeat(std::uint8_t mode, float amount, float max_speed) {
    usher_msgs::msg::FollowGoal goal;
    goal.id(goal_id);
    goal.client("navigator");
    goal.mode(mode);
    goal.amount(amount);
    goal.max_speed(max_speed);
    std::vector<geometry::Pose2> path;
    if (mode == MODE_PATH) path = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    goal.path(wire::to_message(host.now(), frames::kMap, path));
    host.publish(topics::kFollowGoal, goal);
  }
  geometry::Twist2 commanded() const {
    const auto command = host.last(topics::kCmdVelNavigation);
    return command ? *wire::from_message(command->twist()) : geometry::Twist2{};
  }
  usher_msgs::msg::FollowStatus status() const { return host.last(topics::kFollowStatus).value(); }

  grid::Grid<std::uint8_t> costs{{80, 80, 0.05, -2.0, -2.0}, 0};
  static runtime::ComponentFactory factory() {
    const std::string type = GetParam();
    return type == "local_planner" ? runtime::component_factory<LocalPlannerComponent>(type)
                                   : runtime::component_factory<WaypointFollowerComponent>(type);
  }
  runtime::TestHost host{factory(), kFootprint};
  std::uint64_t goal_id = 0;
};
INSTANTIATE_TEST_SUITE_P(All, Component, testing::Values("local_planner", "waypoint_follower"));

TEST_P(Component, DrivesAlongAPath) {
  run(500);
  tell(MODE_PATH);
  run(1500);
  EXPECT_GT(commanded().v, 0.3);
  EXPECT_EQ(status().id(), goal_id);
  EXPECT_EQ(status().state(), STATE_ACTIVE) << status().reason();
}

TEST_P(Component, TakesAnotherPaceOnTheSamePath) {
  run(500);
  tell(MODE_PATH);
  run(1500);
  ASSERT_GT(commanded().v, 0.3);
  repeat(MODE_PATH, 0.0F, 0.2F);
  run(1500);
  EXPECT_NEAR(commanded().v, 0.2, 0.02);
  repeat(MODE_PATH, 0.0F, 0.0F);
  run(1500);
  EXPECT_GT(commanded().v, 0.3) << "0 is the planner's own limit";
}

TEST_P(Component, StandsAndForgetsItsGoalWithoutTheNavigator) {
  run(500);
  tell(MODE_PATH);
  run(1500);
  run(500, false);
  EXPECT_GT(commanded().v, 0.3) << "a word or two may be lost";
  run(200, false);
  EXPECT_EQ(commanded().v, 0.0);
  EXPECT_EQ(status().id(), 0U) << "so that a navigator that lives gives it again";
  run(1000);
  EXPECT_EQ(commanded().v, 0.0) << "not by itself";
  tell(MODE_PATH);
  run(1500);
  EXPECT_GT(commanded().v, 0.3);
}

TEST_P(Component, DrivesForNobodyBeforeItEverHeardTheNavigator) {
  run(2000, false);
  tell(MODE_PATH);
  run(1000, false);
  EXPECT_EQ(commanded().v, 0.0);
}

TEST_P(Component, EndsARecoveryWithoutTheNavigatorToo) {
  run(500);
  tell(MODE_ROTATE, 1.5F);
  run(1000);
  EXPECT_GT(commanded().w, 0.1);
  run(700, false);
  EXPECT_EQ(commanded().w, 0.0);
}

TEST_P(Component, RefusesRecoveriesThatGoTooFarOrNowhere) {
  run(500);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::uint64_t refused = 0;
  for (const auto& [mode, amount] : {std::pair{MODE_ROTATE, 7.0F},
                                     {MODE_ROTATE, -1e9F},
                                     {MODE_ROTATE, kNan},
                                     {MODE_BACK_OFF, 3.5F},
                                     {MODE_BACK_OFF, std::numeric_limits<float>::infinity()}}) {
    tell(mode, amount);
    run(1100);
    EXPECT_EQ(commanded().v, 0.0);
    EXPECT_EQ(commanded().w, 0.0);
    EXPECT_EQ(host.counter("inputs: rejected"), ++refused) << amount;
  }
}

}  // namespace
}  // namespace usher::local_planner
