#include "navigation/global_planner/shell/component.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::global_planner {
namespace {

using geometry::Pose2;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace usher_msgs::msg::GoalStatus_Constants;

/// A free floor of 10 x 10 m, and a client that wants to cross it.
class Component : public testing::Test {
 protected:
  void give_costs() {
    host.publish(topics::kGlobalCosts, wire::to_message(host.now(), frames::kMap, costs));
    host.run_for(milliseconds(5));
  }
  usher_msgs::msg::PlanRequest request(const Pose2& start, const Pose2& goal) {
    usher_msgs::msg::PlanRequest message;
    message.id(++id);
    message.client("navigator");
    message.start().header(wire::header(host.now(), frames::kMap));
    message.start().pose(wire::to_message(start));
    message.goal().header(wire::header(host.now(), frames::kMap));
    message.goal().pose(wire::to_message(goal));
    return message;
  }
  usher_msgs::msg::PlanReply ask(const usher_msgs::msg::PlanRequest& message) {
    host.publish(topics::kPlanRequest, message);
    host.run_for(milliseconds(5));
    return host.last(topics::kPlanReply).value();
  }
  usher_msgs::msg::PlanReply ask(const Pose2& start, const Pose2& goal) {
    return ask(request(start, goal));
  }
  std::string reason() {
    host.run_for(milliseconds(110));  // for a heartbeat
    return host.heartbeat().reason();
  }

  grid::Grid<std::uint8_t> costs{{100, 100, 0.1, 0.0, 0.0}, 0};
  std::uint64_t id = 0;
  runtime::TestHost host{runtime::component_factory<GlobalPlannerComponent>("global_planner")};
};

TEST_F(Component, AnswersWithAPathInTheMap) {
  give_costs();
  const auto reply = ask({1, 1, 0}, {9, 1, 0.5});
  EXPECT_EQ(reply.id(), id);
  ASSERT_EQ(reply.state(), STATE_SUCCEEDED) << reply.reason();
  EXPECT_NEAR(reply.length(), 8.0F, 0.1F);
  EXPECT_EQ(reply.path().header().frame_id(), frames::kMap);
  const auto path = wire::from_message(reply.path());
  ASSERT_TRUE(path);
  EXPECT_NEAR(geometry::distance(path->front(), {1, 1, 0}), 0.0, 1e-9);
  EXPECT_NEAR(geometry::distance(path->back(), {9, 1, 0.5}), 0.0, 1e-9);
  EXPECT_NEAR(path->back().yaw, 0.5, 1e-9);
  EXPECT_EQ(host.last(topics::kPlan)->poses().size(), path->size());
}

TEST_F(Component, FailsWithoutCostsAndReturnsWithThem) {
  EXPECT_EQ(ask({1, 1, 0}, {9, 1, 0}).reason(), "no global costs") << "never heard";
  give_costs();
  EXPECT_EQ(ask({1, 1, 0}, {9, 1, 0}).state(), STATE_SUCCEEDED);
  EXPECT_EQ(reason(), "");
  host.run_for(milliseconds(3100));
  const auto reply = ask({1, 1, 0}, {9, 1, 0});
  EXPECT_EQ(reply.state(), STATE_FAILED);
  EXPECT_EQ(reply.reason(), "no global costs");
  EXPECT_THAT(reply.path().poses(), IsEmpty());
  EXPECT_EQ(reason(), "no global costs");
  give_costs();
  EXPECT_EQ(ask({1, 1, 0}, {9, 1, 0}).state(), STATE_SUCCEEDED);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, RefusesCostsThatAreNone) {
  give_costs();
  auto none = wire::to_message(host.now(), frames::kMap, costs);
  none.resolution(std::numeric_limits<float>::quiet_NaN());
  host.publish(topics::kGlobalCosts, none);
  EXPECT_THAT(reason(), HasSubstr("global costs refused: "));
  host.publish(topics::kGlobalCosts, wire::to_message(host.now(), frames::kOdom, costs));
  EXPECT_EQ(reason(), "global costs refused: expected the frame map, got 'odom'");
  EXPECT_EQ(host.counter("costs: rejected"), 2U);
  EXPECT_EQ(ask({1, 1, 0}, {9, 1, 0}).state(), STATE_SUCCEEDED) << "on the last ones";
}

TEST_F(Component, SaysWhyThereIsNoPath) {
  for (int y = 0; y < 100; ++y) costs.at({50, y}) = 254;
  give_costs();
  const auto reply = ask({1, 1, 0}, {9, 1, 0});
  EXPECT_EQ(reply.state(), STATE_FAILED);
  EXPECT_NE(reply.reason(), "");
  EXPECT_EQ(reason(), "") << "that is no fault of the planner";
  EXPECT_EQ(host.counter("plans: failed"), 1U);
}

}  // namespace
}  // namespace usher::global_planner
