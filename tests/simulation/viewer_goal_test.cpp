// A goal that is clicked in rviz, before the whole robot.
#include <gtest/gtest.h>

#include <memory>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

using std::chrono::seconds;
namespace goal_state = usher_msgs::msg::GoalStatus_Constants;
namespace supervisor_state = usher_msgs::msg::SupervisorStatus_Constants;

constexpr geometry::Pose2 kReception{10.2, 4.6, 0.0};  // of the office, in map

TEST(ViewerGoal, IsDrivenToAndLeavesTheRobotToItsVisitors) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const auto deployment = load_deployment(share + "/deploy/marvin-sim.yaml", installation, {});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  const auto made = LockstepRun::create(*deployment, 1);
  ASSERT_TRUE(made.ok()) << made.error();
  LockstepRun& run = **made;
  auto& world = run.world();
  std::uint8_t state = 0;
  bool granted = false;
  world.observe(topics::kSupervisorStatus, [&](const auto& status, const auto&) {
    state = status.state();
    granted = status.granted();
  });
  std::uint8_t outcome = 0;
  world.observe(topics::kNavigateStatus, [&](const auto& status, const auto&) {
    if (status.client() == "goal_pose") outcome = status.state();
  });
  const auto becomes = [&](seconds limit, const auto& condition) {
    const auto until = world.now() + limit;
    while (world.now() < until && !condition()) world.run_for(std::chrono::milliseconds(100));
    return condition();
  };
  ASSERT_TRUE(becomes(seconds(30), [&] {
    return granted && state == supervisor_state::STATE_INTERACTION;
  })) << run.complaints();

  geometry_msgs::msg::PoseStamped goal;
  goal.header(wire::header(world.now(), "map"));
  goal.pose(wire::to_message(kReception));
  world.publish(topics::kGoalPose, goal, "rviz");
  ASSERT_TRUE(becomes(seconds(240), [&] { return outcome == goal_state::STATE_SUCCEEDED; }))
      << static_cast<int>(outcome) << "\n"
      << run.complaints();
  EXPECT_LT((run.record().samples().back().truth.position() - kReception.position()).norm(), 0.5);
  EXPECT_TRUE(becomes(seconds(3), [&] { return state == supervisor_state::STATE_INTERACTION; }));
}

}  // namespace
}  // namespace usher::operations
