#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"

namespace usher::visitor_tracker {
namespace {

class Following : public Scene {};

TEST_F(Following, TheOneWhoStoodThereStaysTheVisitorWhereverHeGoes) {
  follow();
  drives = 0.0;
  add(2, robot.position() + Point2(1.0, 0.0));  // stands before the robot
  run(4.0);
  EXPECT_TRUE(sees(1)) << "5.5 m away";
  robot.yaw = geometry::kPi / 2;  // beside
  run(0.1);
  EXPECT_TRUE(sees(1));
  robot.yaw = 0.0;
  person(1).velocity = {-1.0, 0.3};
  run(7.0);
  EXPECT_LT(estimate.place.x(), 0.0);
  EXPECT_TRUE(sees(1)) << "walked past the robot";
}

TEST_F(Following, FartherThanItSeesIsNobody) {
  follow();
  drives = 0.0;
  run(6.3);
  EXPECT_TRUE(sees(1));
  run(0.6);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
  person(1).velocity = {-1.0, 0.0};
  run(1.0);
  EXPECT_TRUE(sees(1)) << "the same one";
}

TEST_F(Following, WhoWasNotKnownWhenItBeganIsTheNearestBeforeTheRobot) {
  service = Service::kFollows;
  EXPECT_EQ(run(1.0).presence, Presence::kNobody);
  add(3, {2.5, 0.2});
  add(4, {1.5, 0.2});
  run(1.0);
  EXPECT_TRUE(sees(4));
}

TEST_F(Following, LossIsSaidWithinASecondAndOnlyWhereACameraLooks) {
  follow();
  hide(1);
  ahead = false;
  EXPECT_EQ(run(0.3).presence, Presence::kUnknown);
  ahead = true;
  EXPECT_EQ(run(0.1).presence, Presence::kNobody);
  robot.yaw = geometry::kPi;  // he was last seen behind it
  EXPECT_EQ(run(0.1).presence, Presence::kNobody);
  behind = false;
  EXPECT_EQ(run(0.1).presence, Presence::kUnknown);
}

TEST_F(Following, HiddenForAMomentIsNoLoss) {
  follow();
  person(1).unseen = 0.4;
  run(0.1);
  EXPECT_TRUE(sees(1));
  person(1).unseen = 0.6;
  EXPECT_EQ(run(0.1).presence, Presence::kNobody);
}

TEST_F(Following, AnotherNumberWhereHeWasGoingToBeIsHe) {
  follow();
  const Point2 there = person(1).position;
  hide(1);
  run(1.5);
  add(5, there + Point2(1.8, 0.2), {1.0, 0.1});
  run(0.1);
  EXPECT_TRUE(sees(5));
  hide(5);
  drives = 0.0;
  run(2.0);
  add(6, there + Point2(2.7, 0.2));  // has stopped meanwhile
  run(0.1);
  EXPECT_TRUE(sees(6));
}

TEST_F(Following, WhoCrossesOrComesTowardTheRobotThereIsNot) {
  follow();
  drives = 0.0;
  const Point2 there = person(1).position;
  hide(1);
  run(0.5);
  add(5, there + Point2(0.5, -0.3), {0.0, 1.2});
  add(6, there + Point2(0.7, 0.3), {-1.0, 0.0});
  for (int i = 0; i < 12; ++i) {
    run(0.1);
    EXPECT_NE(estimate.presence, Presence::kSeen) << i;
  }
}

TEST_F(Following, WhoWalkedBesideHimOrCameFromElsewhereIsNot) {
  follow();
  add(2, person(1).position + Point2(0.1, 0.9), {1.0, 0.0});
  run(1.0);
  const Point2 there = person(1).position;
  hide(1);
  add(7, there + Point2(-1.0, -1.8), {0.9, 1.0});
  run(1.5);
  person(7).velocity = {1.0, 0.0};
  person(2).velocity = {1.0, -0.5};
  for (int i = 0; i < 20; ++i) {
    run(0.1);
    EXPECT_NE(estimate.presence, Presence::kSeen) << i;
  }
}

TEST_F(Following, WhoWearsSomethingElseIsNotHe) {
  worn = {in(kRed), {}};
  follow();
  person(1).appearances[0] = in(kNavy);
  run(1.0);
  EXPECT_FALSE(sees(1)) << "his number was given to somebody else";
  worn = {in(kRed), {}};
  add(6, person(1).position + Point2(0.3, 0.3), {1.0, 0.0});
  run(0.5);
  EXPECT_TRUE(sees(6));
}

TEST_F(Following, WhoWearsHisClothesIsFoundLongAfterTheLoss) {
  worn = {in(kRed), {}};
  follow();
  drives = 0.0;
  const Point2 there = person(1).position;
  hide(1);
  run(5.0);
  worn = {in(kNavy), {}};
  add(5, there + Point2(1.0, 1.0));
  EXPECT_EQ(run(2.0).presence, Presence::kNobody);
  worn = {in(kRed), {}};
  add(7, there + Point2(1.0, -1.0));
  EXPECT_EQ(run(0.5).presence, Presence::kNobody) << "a glance is not enough";
  run(0.5);
  EXPECT_TRUE(sees(7));
}

TEST_F(Following, NobodyInHisClothesHasWalkedSoFast) {
  worn = {in(kRed), {}};
  follow();
  drives = 0.0;
  const Point2 there = person(1).position;
  hide(1);
  add(6, there + Point2(0.0, 4.0));
  EXPECT_EQ(run(1.9).presence, Presence::kNobody);
  run(0.5);
  EXPECT_TRUE(sees(6)) << "by now he may have";
}

TEST_F(Following, LongAfterALossWhoWalksThereIsNot) {
  follow();
  drives = 0.0;
  const Point2 there = person(1).position;
  hide(1);
  run(4.5);
  add(5, there + Point2(1.5, 0.0), {1.0, 0.0});
  EXPECT_EQ(run(1.0).presence, Presence::kNobody);
}

TEST_F(Following, WhoComesBackAndStandsAtTheRobotIsHe) {
  follow();
  drives = 0.0;
  hide(1);
  run(8.0);
  add(4, robot.position() + Point2(2.6, 0.5));
  EXPECT_EQ(run(4.0).presence, Presence::kNobody) << "stands too far off";
  add(5, robot.position() + Point2(4.0, -0.5), {-1.0, 0.0});
  run(2.5);
  person(5).velocity = {0, 0};
  EXPECT_EQ(run(2.0).presence, Presence::kNobody) << "may be passing";
  run(1.0);
  EXPECT_TRUE(sees(5));
}

TEST_F(Following, WhoStoodThereAllTheTimeIsNot) {
  follow();
  drives = 0.0;
  add(2, robot.position() + Point2(1.2, 0.8));
  run(2.0);
  hide(1);
  EXPECT_EQ(run(8.0).presence, Presence::kNobody);
  person(2).velocity = {0.0, -0.5};
  run(2.0);
  person(2).velocity = {0.0, 0.0};
  run(3.0);
  EXPECT_TRUE(sees(2)) << "came to stand before it: perhaps the numbers were taken for another";
}

TEST_F(Following, TheFirstIdentityCountsWhenItComesBack) {
  follow();
  Person first = person(1);
  hide(1);
  run(0.5);
  add(5, first.position + Point2(0.5, 0.1), {1.0, 0.0});
  run(0.5);
  ASSERT_TRUE(sees(5));
  first.position = robot.position() + Point2(2.5, 1.5);
  people.push_back(first);
  run(0.1);
  EXPECT_TRUE(sees(1));
}

TEST_F(Following, WhoWentWhereNothingLooksIsThereUntilTheRobotTurns) {
  follow();
  drives = 0.0;
  person(1).velocity = {0, 0};
  person(1).position = robot.position() + 1.2 * Point2(std::cos(2.2), std::sin(2.2));
  run(0.1);
  hide(1);
  run(3.0);
  EXPECT_TRUE(sees(1));
  robot.yaw = 1.5;
  EXPECT_EQ(run(0.1).presence, Presence::kNobody);
}

}  // namespace
}  // namespace usher::visitor_tracker
