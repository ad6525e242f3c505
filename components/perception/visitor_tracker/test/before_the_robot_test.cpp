#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"

namespace usher::visitor_tracker {
namespace {

class BeforeTheRobot : public Scene {};
class Wrong : public Scene {};

TEST_F(BeforeTheRobot, WhoStandsThereForAMomentIsTheVisitor) {
  EXPECT_EQ(run(1.0).presence, Presence::kNobody);
  add(7, {1.5, 0.4});
  run(0.3);
  EXPECT_EQ(estimate.presence, Presence::kNobody) << "not yet";
  run(0.3);
  ASSERT_TRUE(sees(7));
  EXPECT_NEAR(estimate.place.x(), 1.5, 1e-9);
  EXPECT_NEAR(estimate.place.y(), 0.4, 1e-9);
  EXPECT_EQ(estimate.speed, 0.0);
}

TEST_F(BeforeTheRobot, PlacesAreThoseOfTheRobotsFrame) {
  robot = {3.0, 2.0, geometry::kPi / 2};
  add(7, {3.0, 4.0});
  run(1.0);
  ASSERT_TRUE(sees(7));
  EXPECT_NEAR(estimate.place.x(), 2.0, 1e-9);
  EXPECT_NEAR(estimate.place.y(), 0.0, 1e-9);
}

TEST_F(BeforeTheRobot, WhoPassesByIsNobody) {
  add(7, {2.0, -4.0}, {0.0, 1.2});
  for (int i = 0; i < 60; ++i) {
    run(0.1);
    EXPECT_EQ(estimate.presence, Presence::kNobody) << person(7).position.y();
  }
}

TEST_F(BeforeTheRobot, WhoComesUpToItIsTheVisitorBeforeStanding) {
  add(7, {4.5, 0.3}, {-1.2, 0.0});
  run(1.6);
  EXPECT_TRUE(sees(7));
  EXPECT_NEAR(estimate.speed, 1.2, 1e-9);
}

TEST_F(BeforeTheRobot, WhoStandsBehindOrFarOffIsNobody) {
  add(7, {-1.5, 0.0});
  add(8, {3.8, 0.0});
  add(9, {0.5, 1.5});
  EXPECT_EQ(run(3.0).presence, Presence::kNobody);
}

TEST_F(BeforeTheRobot, OfTwoTheNearestUntilTheOtherIsClearlyNearer) {
  add(1, {1.5, 0.5});
  add(2, {1.7, -0.5});
  run(1.0);
  EXPECT_TRUE(sees(1));
  person(2).position = {1.3, -0.3};
  run(1.0);
  EXPECT_TRUE(sees(1)) << "nearer by a hand only";
  person(2).position = {0.9, -0.2};
  run(1.0);
  EXPECT_TRUE(sees(2));
}

TEST_F(BeforeTheRobot, WhoIsServedIsNotLeftForSomebodyNearer) {
  add(1, {1.5, 0.5});
  run(1.0);
  service = Service::kTalks;
  add(2, {0.8, 0.0});
  run(5.0);
  EXPECT_TRUE(sees(1));
  hide(1);
  run(1.0);
  EXPECT_TRUE(sees(2)) << "who stands at the screen when the first one is gone";
}

TEST_F(BeforeTheRobot, WhoIsServedMayStepAsideOrBehind) {
  add(1, {1.2, 0.0});
  run(1.0);
  service = Service::kTalks;
  person(1).position = {-1.0, -0.8};
  EXPECT_EQ(run(1.0).presence, Presence::kSeen);
  EXPECT_LT(estimate.place.x(), 0.0);
}

TEST_F(BeforeTheRobot, WhoWalksOffIsNoLongerTheVisitorOnceNobodyIsServed) {
  add(1, {1.2, 0.0});
  run(1.0);
  person(1).velocity = {1.3, 0.0};
  run(1.0);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
}

TEST_F(BeforeTheRobot, WithoutACameraNobodyIsNotKnown) {
  ahead = false;
  EXPECT_EQ(run(1.0).presence, Presence::kUnknown);
  add(1, {1.2, 0.0});
  EXPECT_EQ(run(1.0).presence, Presence::kSeen);
}

TEST_F(Wrong, PeopleWhoAreNowhereAreLeftOut) {
  add(1, {kNan, 0.0});
  add(2, {1.2, 0.0}, {kNan, 0.0});
  add(3, {1.2, 0.0}).unseen = kNan;
  add(0, {1.2, 0.0});
  EXPECT_EQ(run(2.0).presence, Presence::kNobody);
}

TEST_F(Wrong, APoseThatIsNoneMakesTheVisitorUnknown) {
  add(1, {1.2, 0.0});
  run(1.0);
  robot.x = kNan;
  EXPECT_EQ(once().presence, Presence::kUnknown);
  robot.x = 0.0;
  time += kStep;
  EXPECT_EQ(once().presence, Presence::kSeen);
  time = kNan;
  EXPECT_EQ(once().presence, Presence::kUnknown);
}

TEST_F(Wrong, AfterAJumpOfTimeNobodyHasStoodThereYet) {
  add(1, {1.2, 0.0});
  run(0.35);
  time += 30.0;
  EXPECT_EQ(run(0.2).presence, Presence::kNobody);
  time -= 60.0;
  once();
  EXPECT_EQ(estimate.presence, Presence::kNobody);
  EXPECT_EQ(run(0.6).presence, Presence::kSeen);
}

TEST_F(Wrong, AfterAJumpOfTheOdometryNobodyHasFollowedYet) {
  guide();
  hide(1);
  run(2.0);
  add(6, robot.position() + Point2(1.1, 0.0), {-1.0, 0.0});
  run(0.5);
  robot.x += 0.8;
  person(6).position.x() += 0.8;
  run(0.2);
  EXPECT_NE(estimate.presence, Presence::kSeen);
}

TEST_F(Wrong, ANumberThatWasGivenAgainIsAnother) {
  guide();
  person(1).age = 0.3;  // its tracker was restarted
  person(1).position = robot.position() + Point2(-3.0, 0.0);
  person(1).velocity = {1.0, 0.0};
  run(0.2);
  EXPECT_FALSE(sees(1));
}

TEST_F(Wrong, SilenceIsUnknownAndForgetsNobody) {
  guide();
  EXPECT_EQ(tracker.lose().presence, Presence::kUnknown);
  EXPECT_EQ(tracker.lose().person, 1U);
  run(0.1);
  EXPECT_TRUE(sees(1));
}

TEST_F(Wrong, ACrowdAtTheRobotLeavesOneVisitor) {
  for (std::uint64_t id = 1; id <= 64; ++id) {
    const double angle = 0.02 * static_cast<double>(id) - 0.65;
    const double range = 1.0 + 0.03 * static_cast<double>(id);
    add(id, {range * std::cos(angle), range * std::sin(angle)});
  }
  run(1.0);
  EXPECT_TRUE(sees(1));
  service = Service::kTalks;
  run(2.0);
  EXPECT_TRUE(sees(1));
}

}  // namespace
}  // namespace usher::visitor_tracker
