// The shell, and what it does when something that it reads is lost, late or wrong: the README's
// table.
#include "navigation/explorer/shell/component.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "foundation/grid/test/rooms.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::explorer {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::GoalStatus_Constants;
namespace localization = usher_msgs::msg::LocalizationStatus_Constants;

constexpr const char* kParameters =
    "{robot.footprint: [0.228, 0.191, -0.228, 0.191, -0.228, -0.191, 0.228, -0.191], "
    "site.meeting_rooms: [{name: east, west: 10.1, south: 0, east: 20, north: 10}]}";

class Component : public testing::Test {
 protected:
  void give_map(const grid::OccupancyGrid& map = grid::two_rooms()) {
    host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, map));
  }
  void run(int ms) {
    for (int at = 0; at < ms; at += 50) {
      if (transforms) {
        tf2_msgs::msg::TFMessage message;
        message.transforms().push_back(wire::transform(
            host.now(), frames::kOdom, frames::kBaseFootprint, geometry::to_space(robot)));
        message.transforms().push_back(
            wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::Pose3{}));
        host.publish(topics::kTf, message);
      }
      if (localizes) {
        usher_msgs::msg::LocalizationStatus status;
        status.header(wire::header(host.now(), frames::kMap));
        status.state(localized);
        host.publish(topics::kLocalizationStatus, status);
      }
      if (navigates) {
        usher_msgs::msg::NavigateStatus status;
        status.header(wire::header(host.now(), frames::kMap));
        status.id(navigation_id);
        status.client(navigation_id == 0 ? "" : "explorer");
        status.state(navigation_state);
        host.publish(topics::kNavigateStatus, status);
      }
      if (asks && at % 500 == 0) host.publish(topics::kExploreGoal, goal);
      host.run_for(milliseconds(50));
    }
  }
  void explore() {
    goal.id(4);
    goal.client("meeting");
    goal.max_speed(0.5F);
    asks = true;
    run(200);
  }
  void answer(std::uint8_t state) {
    navigation_id = drive().id();
    navigation_state = state;
    run(200);
  }
  usher_msgs::msg::NavigateGoal drive() const { return host.last(topics::kNavigateGoal).value(); }
  std::size_t drives() const { return host.written(topics::kNavigateGoal).size(); }
  usher_msgs::msg::ExploreStatus status() const {
    return host.last(topics::kExploreStatus).value();
  }
  void expect_waiting(const std::string& reason) {
    EXPECT_EQ(status().state(), STATE_WAITING);
    EXPECT_EQ(status().reason(), reason);
    EXPECT_EQ(host.heartbeat().reason(), reason);
  }

  runtime::TestHost host{runtime::component_factory<ExplorerComponent>("explorer"), kParameters};
  geometry::Pose2 robot{3.0, 5.0, 0.0};
  usher_msgs::msg::ExploreGoal goal;
  bool asks = false;
  bool transforms = true, localizes = true, navigates = true;
  std::uint8_t localized = localization::STATE_GOOD;
  std::uint64_t navigation_id = 0;
  std::uint8_t navigation_state = STATE_IDLE;
};

TEST_F(Component, SendsTheNavigatorFromViewToView) {
  give_map();
  run(500);
  explore();
  ASSERT_GE(drives(), 1U);
  const auto first = drive();
  EXPECT_EQ(first.client(), "explorer");
  EXPECT_EQ(first.pose().header().frame_id(), frames::kMap);
  EXPECT_EQ(first.max_speed(), 0.5F);
  EXPECT_EQ(status().id(), 4U);
  EXPECT_EQ(status().client(), "meeting");
  answer(STATE_ACTIVE);
  robot = *wire::to_planar(first.pose().pose());
  answer(STATE_SUCCEEDED);
  EXPECT_GT(drive().id(), first.id());
  EXPECT_EQ(status().views(), 1U);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
}

TEST_F(Component, TellsWhatWasSeenOfWhatIsToBeSeen) {
  give_map();
  run(1000);
  const auto seen = status();
  EXPECT_NEAR(seen.area(), 9.85 * 9.9, 3.0) << "without the room in the east";
  EXPECT_NEAR(seen.coverage() * seen.area(), 6.05, 0.5) << "the sector, while nobody explores too";
  robot.yaw = geometry::kPi;
  run(500);
  EXPECT_GT(status().coverage(), 1.5F * seen.coverage());
}

TEST_F(Component, RepeatsADriveUntilTheNavigatorNamesIt) {
  give_map();
  run(500);
  explore();
  run(800);
  const auto all = host.written(topics::kNavigateGoal);
  EXPECT_GE(all.size(), 4U);
  EXPECT_TRUE(std::all_of(all.begin(), all.end(),
                          [&](const auto& each) { return each.id() == all.front().id(); }));
  answer(STATE_ACTIVE);
  const auto sent = drives();
  run(1000);
  EXPECT_EQ(drives(), sent);
}

TEST_F(Component, EndsWhenWhoAskedIsSilent) {
  give_map();
  run(500);
  explore();
  answer(STATE_ACTIVE);
  run(5000);
  ASSERT_EQ(status().state(), STATE_ACTIVE);
  asks = false;
  run(3500);
  EXPECT_EQ(status().state(), STATE_FAILED);
  EXPECT_EQ(status().reason(), "'meeting' is silent");
  EXPECT_EQ(host.last(topics::kNavigateCancel)->id(), drive().id());
}

TEST_F(Component, CancelsItsDriveWhenItIsCancelled) {
  give_map();
  run(500);
  explore();
  answer(STATE_ACTIVE);
  usher_msgs::msg::GoalCancel cancel;
  cancel.id(4);
  cancel.client("meeting");
  host.publish(topics::kExploreCancel, cancel);
  run(200);
  EXPECT_EQ(status().state(), STATE_CANCELLED);
  EXPECT_EQ(host.last(topics::kNavigateCancel)->id(), drive().id());
  const auto sent = drives();
  run(1000);
  EXPECT_EQ(drives(), sent);
}

TEST_F(Component, WaitsForAMapAndKeepsTheOneItHas) {
  run(500);
  explore();
  expect_waiting("no map");
  give_map(grid::OccupancyGrid({.width = 4500, .height = 2, .resolution = 0.05}, grid::kFree));
  run(200);
  EXPECT_EQ(host.heartbeat().reason(),
            "map refused: the map may have 4000 cells a side, it has 4500");
  EXPECT_EQ(host.counter("inputs: rejected"), 1U);
  give_map();
  run(200);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
  host.publish(topics::kMap, nav_msgs::msg::OccupancyGrid{});
  run(1100);
  EXPECT_EQ(host.counter("inputs: rejected"), 2U);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
}

TEST_F(Component, WaitsForTheNavigatorAndTellsItAnew) {
  give_map();
  run(500);
  explore();
  answer(STATE_ACTIVE);
  const auto before = drive();
  navigates = false;
  run(2500);
  expect_waiting("no navigator");
  navigates = true;
  navigation_id = 0;
  navigation_state = STATE_IDLE;
  run(4000);
  EXPECT_GT(drive().id(), before.id());
  EXPECT_EQ(drive().pose().pose(), before.pose().pose());
}

TEST_F(Component, TakesNothingForSeenWithoutLocalization) {
  give_map();
  run(500);
  explore();
  answer(STATE_ACTIVE);
  const auto seen = status().coverage();
  localized = localization::STATE_LOST;
  robot.yaw = geometry::kPi;
  run(500);
  expect_waiting("robot not localized");
  EXPECT_EQ(status().coverage(), seen);
  localized = localization::STATE_DEGRADED;
  run(500);
  EXPECT_EQ(status().state(), STATE_ACTIVE);
  EXPECT_GT(status().coverage(), seen);
}

TEST_F(Component, TakesNothingForSeenWhenLocalizationOrTheFramesAreSilent) {
  give_map();
  run(500);
  explore();
  for (bool* source : {&localizes, &transforms}) {
    const auto seen = status().coverage();
    *source = false;
    run(2500);
    expect_waiting("robot not localized");
    *source = true;
    run(500);
    EXPECT_EQ(host.heartbeat().reason(), "");
    EXPECT_GE(status().coverage(), seen);
  }
}

TEST_F(Component, RefusesGoalsThatAreNone) {
  give_map();
  run(500);
  goal.id(9);
  goal.max_speed(std::numeric_limits<float>::quiet_NaN());
  host.publish(topics::kExploreGoal, goal);
  run(300);
  EXPECT_EQ(status().id(), 9U);
  EXPECT_EQ(status().state(), STATE_FAILED);
  EXPECT_EQ(drives(), 0U);
}

TEST_F(Component, TakesItsShareAndRefusesOneThatIsNone) {
  give_map();
  run(300);
  usher_msgs::msg::ExploreShare share;
  share.places().resize(2);
  share.places()[0].x(2.0);
  share.places()[0].y(5.0);
  share.places()[1].x(8.0);
  share.places()[1].y(5.0);
  share.own(2);
  host.publish(topics::kExploreShare, share);
  run(200);
  EXPECT_EQ(host.counter("inputs: rejected"), 1U);
  share.own(1);
  host.publish(topics::kExploreShare, share);
  run(200);
  EXPECT_EQ(host.counter("inputs: rejected"), 1U);
  EXPECT_TRUE(host.written(topics::kFleetLook).empty()) << "it is in no fleet";
}

}  // namespace
}  // namespace usher::explorer
