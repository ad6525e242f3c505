#include "navigation/explorer/core/explorer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/grid/test/rooms.hpp"

namespace usher::explorer {
namespace {

/// An explorer with a navigator that brings the robot where it is told in one step.
class Rig : public testing::Test {
 protected:
  void make(ExplorerConfig config = {}) {
    config.strategy.candidate_spacing = 1.0;  // it is not about the best view
    explorer.emplace(std::move(Explorer::create(config, 1, 100)).value());
  }
  void begin(ExploreRequest request = {.id = 5, .client = "meeting", .anew = true}) {
    ASSERT_TRUE(explorer->set_map(grid::two_rooms()));
    explorer->request(request);
  }
  /// One step of 0.1 s with what the navigator said last.
  Decision step() {
    time += 0.1;
    if (asks && explorer->active()) explorer->request({.id = status().id, .client = "meeting"});
    if (localized) explorer->look(robot);
    Situation s;
    s.time = time;
    if (localized) s.pose = robot;
    if (heard) s.navigation = report;
    s.client = "explorer";
    const Decision decision = explorer->step(s);
    if (decision.drive) drives.push_back(*decision.drive);
    if (decision.cancel) cancelled.push_back(*decision.cancel);
    return decision;
  }
  void answer(GoalState state, const std::string& reason = "") {
    report = {drives.back().id, "explorer", state, reason};
  }
  void arrive() {
    robot = drives.back().view;
    answer(GoalState::kSucceeded);
    step();
  }
  const ExploreStatus& status() const { return explorer->status(); }

  std::optional<Explorer> explorer;
  Pose2 robot{2.0, 5.0, 0.0};
  bool localized = true, heard = true, asks = true;
  DriveReport report;
  double time = 10.0;
  std::vector<Drive> drives;
  std::vector<std::uint64_t> cancelled;
};

TEST_F(Rig, DrivesFromViewToViewUntilTheRoundsAreDone) {
  make();
  begin({.id = 5, .client = "meeting", .rounds = 2, .anew = true});
  step();
  for (int i = 0; i < 400 && explorer->active(); ++i) arrive();
  EXPECT_EQ(status().state, GoalState::kSucceeded);
  EXPECT_EQ(status().round, 2U);
  EXPECT_EQ(status().views, drives.size());
  EXPECT_GT(explorer->seen().coverage(), 0.9);
  const auto sent = drives.size();
  step();
  EXPECT_EQ(drives.size(), sent) << "then it rests";
}

TEST_F(Rig, ExploresOnUntilItIsCancelled) {
  make();
  begin();
  step();
  for (int i = 0; i < 150; ++i) arrive();
  EXPECT_EQ(status().state, GoalState::kActive);
  EXPECT_GT(status().round, 1U);
  EXPECT_FALSE(explorer->cancel(99));
  EXPECT_TRUE(explorer->cancel(5));
  step();
  EXPECT_EQ(status().state, GoalState::kCancelled);
  ASSERT_EQ(cancelled.size(), 1U);
  EXPECT_EQ(cancelled.front(), drives.back().id) << "the drive must not go on";
  EXPECT_FALSE(explorer->cancel(0));
}

TEST_F(Rig, WaitsForWhatItNeedsAndSaysForWhat) {
  make();
  explorer->request({.id = 5, .client = "meeting"});
  step();
  EXPECT_EQ(status().state, GoalState::kWaiting);
  EXPECT_EQ(status().reason, "no map");
  ASSERT_TRUE(explorer->set_map(grid::two_rooms()));
  heard = false;
  step();
  EXPECT_EQ(status().reason, "no navigator");
  heard = true;
  localized = false;
  step();
  EXPECT_EQ(status().reason, "robot not localized");
  EXPECT_TRUE(drives.empty());
  localized = true;
  step();
  EXPECT_EQ(status().state, GoalState::kActive);
  EXPECT_EQ(status().reason, "");
  EXPECT_EQ(drives.size(), 1U);
}

TEST_F(Rig, SaysWhatTheNavigatorWaitsFor) {
  make();
  begin();
  step();
  answer(GoalState::kWaiting, "blocked");
  step();
  EXPECT_EQ(status().state, GoalState::kWaiting);
  EXPECT_EQ(status().reason, "blocked");
  answer(GoalState::kActive);
  step();
  EXPECT_EQ(status().state, GoalState::kActive);
  EXPECT_EQ(drives.size(), 1U);
}

TEST_F(Rig, GivesUpAViewpointAndGoesToAnother) {
  make();
  begin();
  step();
  answer(GoalState::kFailed, "no path");
  step();
  ASSERT_EQ(drives.size(), 2U);
  EXPECT_EQ(status().state, GoalState::kActive);
  EXPECT_EQ(status().given_up, 1U);
}

TEST_F(Rig, EndsWhenNobodyAsksForItAnyMore) {
  make();
  begin();
  asks = false;
  for (int i = 0; i < 29; ++i) step();
  EXPECT_EQ(status().state, GoalState::kActive);
  explorer->request({.id = 5, .client = "meeting"});
  for (int i = 0; i < 29; ++i) step();
  EXPECT_EQ(status().state, GoalState::kActive) << "asked once more";
  for (int i = 0; i < 3; ++i) step();
  EXPECT_EQ(status().state, GoalState::kFailed);
  EXPECT_EQ(status().reason, "'meeting' is silent");
  ASSERT_FALSE(cancelled.empty());
  EXPECT_EQ(cancelled.back(), drives.back().id);
}

TEST_F(Rig, GivesUpAViewpointThatTakesTooManyRecoveries) {
  make({.most_failures = 2});
  begin();
  step();
  answer(GoalState::kWaiting, "blocked");
  report.recoveries = 2;
  step();
  EXPECT_EQ(drives.size(), 1U);
  report.recoveries = 3;
  step();
  EXPECT_EQ(drives.size(), 2U);
  EXPECT_EQ(status().given_up, 1U);
  EXPECT_TRUE(cancelled.empty()) << "the new goal replaces the old one";
  answer(GoalState::kWaiting, "blocked");
  report.recoveries = 3;
  step();
  EXPECT_EQ(status().state, GoalState::kFailed);
  ASSERT_EQ(cancelled.size(), 1U);
  EXPECT_EQ(cancelled.front(), drives.back().id) << "but the last one must not go on";
}

TEST_F(Rig, FailsWhenOneViewpointAfterTheOtherCannotBeReached) {
  make({.most_failures = 3});
  begin();
  step();
  answer(GoalState::kFailed, "no path");
  step();
  arrive();
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(explorer->active());
    answer(GoalState::kFailed, "the robot has been stopped");
    step();
  }
  EXPECT_EQ(status().state, GoalState::kFailed);
  EXPECT_EQ(status().reason,
            "3 viewpoints in a row could not be reached, the last one: the robot has been stopped");
}

TEST_F(Rig, EndsWhenSomebodyDrivesTheRobotElsewhere) {
  for (const auto state : {GoalState::kReplaced, GoalState::kCancelled}) {
    make();
    begin();
    drives.clear();
    report = {};
    step();
    answer(GoalState::kActive);
    step();
    answer(state);
    step();
    EXPECT_EQ(status().state, GoalState::kFailed);
    EXPECT_EQ(drives.size(), 1U);
  }
  make();
  begin();
  report = {7, "operator", GoalState::kActive, ""};
  step();
  answer(GoalState::kActive);
  step();
  report = {8, "operator", GoalState::kActive, ""};
  step();
  EXPECT_EQ(status().reason, "'operator' drives the robot elsewhere");
}

TEST_F(Rig, TellsANavigatorThatWasRestartedAnew) {
  make();
  begin();
  step();
  answer(GoalState::kActive);
  step();
  heard = false;
  for (int i = 0; i < 50; ++i) step();
  EXPECT_EQ(status().reason, "no navigator");
  heard = true;
  report = {};
  for (int i = 0; i < 40 && drives.size() < 2; ++i) step();
  ASSERT_EQ(drives.size(), 2U);
  EXPECT_EQ(drives[1].view, drives[0].view);
  EXPECT_GT(drives[1].id, drives[0].id);
}

TEST_F(Rig, LeavesADriveOnceAllWasSeenFromTheWay) {
  make();
  begin();
  step();
  answer(GoalState::kActive);
  explorer->look(drives.back().view);
  step();
  EXPECT_EQ(drives.size(), 2U);
  EXPECT_EQ(status().views, 1U);
  EXPECT_TRUE(cancelled.empty()) << "the new goal replaces the old one";
}

TEST_F(Rig, TakesAReachedViewpointForLookedAt) {
  make();
  begin();
  step();
  const Pose2 view = drives.back().view;
  robot = {2.0, 5.0, geometry::kPi};  // it looks the other way, and never sees it
  answer(GoalState::kSucceeded);
  step();
  ASSERT_EQ(drives.size(), 2U);
  EXPECT_NE(drives.back().view, view);
}

TEST_F(Rig, GoesOnWithWhatItSawUnlessToldToBeginAnew) {
  make();
  begin();
  step();
  for (int i = 0; i < 10; ++i) arrive();
  const double seen = explorer->seen().coverage();
  explorer->request({.id = 6, .client = "meeting"});
  step();
  EXPECT_GE(explorer->seen().coverage(), seen);
  explorer->request({.id = 7, .client = "meeting", .anew = true});
  step();
  EXPECT_LT(explorer->seen().coverage(), seen);
}

TEST_F(Rig, ARepeatedGoalChangesNothing) {
  make();
  begin();
  step();
  arrive();
  const auto views = status().views;
  explorer->request({.id = 5, .client = "meeting", .anew = true});
  step();
  EXPECT_EQ(status().views, views);
}

TEST_F(Rig, RefusesGoalsThatAreNone) {
  make();
  begin();
  step();
  explorer->request({.id = 0, .client = "meeting"});
  explorer->request({.id = 9, .client = "meeting", .max_speed = std::nan("")});
  step();
  EXPECT_EQ(status().id, 5U) << "what runs is not disturbed";
  EXPECT_EQ(status().state, GoalState::kActive);
  explorer->cancel(0);
  explorer->request({.id = 9, .client = "meeting", .max_speed = -1.0});
  EXPECT_EQ(status().id, 9U);
  EXPECT_EQ(status().state, GoalState::kFailed);
  EXPECT_EQ(status().reason, "max_speed must be finite and 0 or more");
}

TEST_F(Rig, FailsWhereTheRobotHasNoRoomAndWhereNothingIsLeft) {
  make();
  begin();
  robot = {17.0, 3.0, 0.0};  // in the middle of a block
  step();
  EXPECT_EQ(status().state, GoalState::kFailed);
  ExplorerConfig config;
  config.leave_out.push_back({{0.0, 0.0}, {20.0, 10.0}});
  make(config);
  begin();
  robot = {2.0, 5.0, 0.0};
  step();
  EXPECT_EQ(status().reason, "there is nothing to look at that the robot can reach");
}

TEST_F(Rig, KeepsItsMapWhenAnotherIsNone) {
  make();
  begin();
  EXPECT_FALSE(explorer->set_map({}));
  step();
  EXPECT_EQ(drives.size(), 1U);
}

TEST(ExplorerConfigs, NameWhatIsOutOfRange) {
  const auto made = Explorer::create({.passing_room = 0.3, .standing_room = 0.2}, 1, 1);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), "standing_room must be in [0.3, 2] m, got 0.2");
  EXPECT_FALSE(Explorer::create({.camera = {.field_of_view = 0.0}}, 1, 1));
  EXPECT_FALSE(Explorer::create({.strategy = {.turn_rate = 0.0}}, 1, 1));
}

}  // namespace
}  // namespace usher::explorer
