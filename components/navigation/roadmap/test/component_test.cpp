#include "navigation/roadmap/shell/component.hpp"

#include <gtest/gtest.h>

#include "foundation/grid/test/rooms.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::roadmap {
namespace {

using namespace grid;

using std::chrono::milliseconds;
using namespace usher_msgs::msg::GoalStatus_Constants;

class Component : public testing::Test {
 protected:
  void give_map(const grid::OccupancyGrid& map) {
    host.publish(topics::kMap, wire::to_message(host.now(), "map", map));
    host.run_for(milliseconds(5));
  }
  /// The map's own obstacles and more of them, as a costmap has them.
  void give_costs(const grid::OccupancyGrid& map, const std::vector<Point2>& things = {}) {
    grid::Grid<std::uint8_t> costs(map.geometry(), 0);
    for (std::size_t i = 0; i < map.size(); ++i) costs[i] = map[i] == grid::kOccupied ? 254 : 0;
    for (const auto& thing : things) costs.at(map.geometry().cell_at(thing)) = 254;
    host.publish(topics::kGlobalCosts, wire::to_message(host.now(), "map", costs));
    host.run_for(milliseconds(5));
  }
  usher_msgs::msg::PlanReply ask(const geometry::Pose2& start, const geometry::Pose2& goal) {
    usher_msgs::msg::PlanRequest request;
    request.id(++id);
    request.client("test");
    request.start().header(wire::header(host.now(), "map"));
    request.start().pose(wire::to_message(start));
    request.goal().header(wire::header(host.now(), "map"));
    request.goal().pose(wire::to_message(goal));
    host.publish(topics::kPlanRequest, request);
    host.run_for(milliseconds(5));
    return host.last(topics::kPlanReply).value();
  }
  static std::vector<Point2> closed_door() {
    std::vector<Point2> things;
    for (double y = 4.61; y < 5.4; y += 0.05) things.emplace_back(10.02, y);
    return things;
  }

  runtime::TestHost host{runtime::component_factory<RoadmapComponent>("roadmap")};
  std::uint64_t id = 0;
};

TEST_F(Component, AnswersWithAPathOnceItHasMapAndCosts) {
  EXPECT_EQ(ask({2, 2, 0}, {12, 9, 1}).reason(), "no map");
  give_map(two_rooms());
  EXPECT_EQ(ask({2, 2, 0}, {12, 9, 1}).reason(), "no global costs");
  give_costs(two_rooms());
  const auto reply = ask({2, 2, 0}, {12, 9, 1});
  ASSERT_EQ(reply.state(), STATE_SUCCEEDED) << reply.reason();
  const auto path = wire::from_message(reply.path());
  ASSERT_TRUE(path);
  EXPECT_EQ(reply.id(), id);
  EXPECT_NEAR(geometry::distance(path->back(), {12, 9, 1}), 0.0, 1e-9);
  EXPECT_NEAR(path->back().yaw, 1.0, 1e-9);
  EXPECT_EQ(host.last(topics::kPlan)->poses().size(), path->size());
}

TEST_F(Component, FailsWhenTheCostsAreStale) {
  give_map(two_rooms());
  give_costs(two_rooms());
  host.run_for(std::chrono::seconds(4));
  EXPECT_EQ(ask({2, 2, 0}, {12, 9, 1}).reason(), "no global costs");
}

TEST_F(Component, AClosedDoorIsAWayOnlyFromAfar) {
  give_map(two_rooms());
  give_costs(two_rooms(), closed_door());
  EXPECT_EQ(ask({8, 5, 0}, {12, 5, 0}).state(), STATE_FAILED);
  EXPECT_EQ(ask({2, 5, 0}, {12, 5, 0}).state(), STATE_SUCCEEDED) << "farther than 4 m: forgotten";
  give_costs(two_rooms());
  EXPECT_EQ(ask({8, 5, 0}, {12, 5, 0}).state(), STATE_SUCCEEDED);
}

TEST_F(Component, RefusesBadInputAndOtherFrames) {
  give_map(two_rooms());
  give_costs(two_rooms());
  EXPECT_EQ(ask({std::nan(""), 5, 0}, {12, 5, 0}).state(), STATE_FAILED);
  nav_msgs::msg::OccupancyGrid broken;
  host.publish(topics::kMap, broken);
  host.run_for(std::chrono::seconds(1));
  EXPECT_EQ(host.counter("inputs: rejected"), 1U);
  EXPECT_EQ(ask({2, 2, 0}, {12, 9, 1}).state(), STATE_SUCCEEDED) << "keeps the map that it had";
}

TEST_F(Component, SaysThatAMapWasRefusedUntilOneIsTaken) {
  give_map(two_rooms());
  give_costs(two_rooms());
  host.publish(topics::kMap, {});
  host.run_for(milliseconds(5));
  give_costs(two_rooms());
  host.run_for(std::chrono::seconds(1));
  EXPECT_NE(host.heartbeat().reason().find("map refused"), std::string::npos);
  give_map(two_rooms());
  give_costs(two_rooms());
  host.run_for(std::chrono::seconds(1));
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_F(Component, TellsTheSameReplyToARepeatedRequest) {
  give_map(two_rooms());
  give_costs(two_rooms());
  const auto first = ask({2, 2, 0}, {12, 9, 1});
  --id;
  EXPECT_EQ(ask({3, 3, 0}, {12, 9, 1}).length(), first.length());
}

}  // namespace
}  // namespace usher::roadmap
