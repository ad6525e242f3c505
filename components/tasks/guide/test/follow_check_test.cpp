#include "tasks/guide/core/follow_check.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::guide {
namespace {

using std::chrono::milliseconds;

class Follow : public testing::Test {
 protected:
  void pass(double gap, int ms) { pass(FollowerSighting{true, gap, true}, ms); }
  void pass_unseen(int ms) { pass(FollowerSighting{}, ms); }
  void pass(const std::optional<FollowerSighting>& sighting, int ms) {
    for (int end = now_ms + ms; now_ms < end;)
      check.update(sighting, at, milliseconds(now_ms += 100));
  }
  void SetUp() override { check.depart({}); }
  FollowCheck check{{}};
  std::optional<geometry::Point2> at;  ///< in map
  int now_ms = 0;
};

TEST_F(Follow, FitsThePaceToTheGap) {
  pass(1.5, 100);
  EXPECT_EQ(check.pace(1.15), 1.15);
  double last = 1.15;
  for (int decimetres = 21; decimetres < 40; ++decimetres) {
    pass(0.1 * decimetres, 100);
    EXPECT_EQ(check.state(), Follower::kLagging);
    EXPECT_LE(check.pace(1.15), last);
    EXPECT_GE(check.pace(1.15), 0.4);
    last = check.pace(1.15);
  }
  pass(4.0, 100);
  EXPECT_TRUE(check.waits());
  EXPECT_EQ(check.pace(1.15), 0.4) << "on the wire 0 were no limit";
}

// A visitor at a steady 0.6 m/s, a robot with 1.48 s of stopping time: the gap settles and never
// reaches the 6 m that are promised.
TEST_F(Follow, KeepsASlowVisitorWithoutWaiting) {
  double robot = 1.0, visitor = 0.0, v = 0.0, largest = 0.0;
  int waits = 0;
  for (int i = 0; i < 1200; ++i) {
    pass(robot - visitor, 100);
    waits += check.waits() ? 1 : 0;
    v += (check.pace(1.15) - v) * 0.1 / 0.6;
    robot += 0.1 * v;
    visitor += 0.1 * 0.6;
    largest = std::max(largest, robot - visitor);
  }
  EXPECT_EQ(waits, 0);
  EXPECT_LT(largest, 4.0);
  EXPECT_NEAR(v, 0.6, 0.05);
}

TEST_F(Follow, NeverLeavesAVisitorWhoStopsMoreThanSixMetresBehind) {
  double robot = 1.5, v = 1.15;
  pass(1.5, 9000);
  for (int i = 0; i < 300; ++i) {
    pass(robot, 100);
    v += ((check.waits() ? 0.0 : check.pace(1.15)) - v) * 0.1 / 0.8;
    robot += 0.1 * v;
  }
  EXPECT_LT(robot, 6.0);
  EXPECT_TRUE(check.waits());
}

TEST_F(Follow, NoticesALossWithinTwoSecondsOfTheDeparture) {
  at = {10.0, 10.0};
  pass(1.5, 200);
  at = {10.6, 10.0};
  pass(1.5, 200);
  int unseen = 0;
  while (!check.waits() && unseen < 5000) pass_unseen(100), unseen += 100;
  EXPECT_LE(unseen, 1200)
      << "half a second more until visitor_tracker says so, and what is on the way";
}

TEST_F(Follow, GivesTheVisitorTimeToStepBehind) {
  pass(FollowerSighting{true, 1.2, false}, 1000);
  pass_unseen(6900);
  EXPECT_FALSE(check.waits());
  pass_unseen(300);
  EXPECT_TRUE(check.waits());
}

TEST_F(Follow, WhoWasSeenBesideARobotThatTurnsMayStillStepBehind) {
  at = {10.0, 10.0};
  pass(1.5, 1000);
  at = {10.3, 10.0};
  pass_unseen(5000);
  EXPECT_FALSE(check.waits());
  at.reset();
  pass(1.5, 100);
  pass_unseen(1100);
  EXPECT_TRUE(check.waits()) << "where it is not known how far the robot went";
}

TEST_F(Follow, GivesNoMoreTimeToStepBehindThanTheRobotStaysNear) {
  at = {10.0, 10.0};
  pass(FollowerSighting{true, 1.2, false}, 500);
  pass_unseen(1000);
  at = {10.0, 12.4};
  pass_unseen(1000);
  EXPECT_FALSE(check.waits());
  at = {10.0, 12.6};
  pass_unseen(100);
  EXPECT_TRUE(check.waits());
  check.depart(milliseconds(now_ms));
  pass_unseen(2000);
  EXPECT_FALSE(check.waits()) << "a new departure, from here";
}

TEST_F(Follow, GoesOnWaitingWhileNobodyLooks) {
  pass(4.5, 1000);
  ASSERT_TRUE(check.waits());
  pass(std::nullopt, 10000);
  EXPECT_TRUE(check.waits()) << "a silent camera brings nobody back";
  EXPECT_EQ(check.calls(), 2U);
  pass(1.5, 100);
  EXPECT_FALSE(check.waits());
  pass(4.5, 100);
  pass(std::nullopt, 60000);
  EXPECT_TRUE(check.lost());
}

TEST_F(Follow, CallsAgainAndAgainThenGivesUp) {
  pass(5.0, 100);
  pass(5.0, 4900);
  EXPECT_EQ(check.state(), Follower::kAwaited);
  pass(5.0, 200);
  EXPECT_EQ(check.state(), Follower::kCalled);
  EXPECT_EQ(check.calls(), 1U);
  pass(5.0, 50000);
  EXPECT_EQ(check.calls(), 11U);
  EXPECT_FALSE(check.lost());
  pass(5.0, 5000);
  EXPECT_TRUE(check.lost());
}

TEST_F(Follow, ResumesOnlyWhenTheVisitorIsNear) {
  pass(4.5, 1000);
  pass(3.0, 1000);
  EXPECT_TRUE(check.waits()) << "hysteresis";
  pass(2.4, 100);
  EXPECT_EQ(check.state(), Follower::kFollowing);
  EXPECT_FALSE(check.lost());
}

TEST_F(Follow, IsUnknownWhileNobodyLooksAndNotANumberIsNotSeen) {
  pass(3.5, 1000);
  pass(std::nullopt, 100);
  EXPECT_EQ(check.state(), Follower::kUnknown);
  EXPECT_EQ(check.pace(1.15), 1.15);
  pass(std::nan(""), 10000);
  EXPECT_TRUE(check.waits());
}

}  // namespace
}  // namespace usher::guide
