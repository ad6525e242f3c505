#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"

namespace usher::visitor_tracker {
namespace {

class OnTheWay : public Scene {};

TEST_F(OnTheWay, IsTheOneWhoWasServed) {
  guide();
  add(2, robot.position() + Point2(0.8, 0.0), {-1.0, 0.0});  // walks along between the two
  run(4.0);
  EXPECT_TRUE(sees(1));
  EXPECT_LT(estimate.place.x(), 0.0) << "behind";
}

TEST_F(OnTheWay, LossIsSaidWithinASecond) {
  guide();
  person(1).unseen = 0.0;
  double since = 0.0;
  for (; estimate.presence == Presence::kSeen && since < 5.0; since += kStep) {
    person(1).unseen += kStep;
    run(kStep / 2);
  }
  EXPECT_LT(since, 0.75);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
  hide(1);
  EXPECT_EQ(run(3.0).presence, Presence::kNobody);
}

TEST_F(OnTheWay, WhoWentWhereNothingLooksIsNotLost) {
  guide();
  drives = 0.0;
  person(1).velocity = {0, 0};
  put(1, 2.2, 2.2);
  run(0.1);
  hide(1);
  run(10.0);
  EXPECT_TRUE(sees(1));
  EXPECT_NEAR(estimate.place.norm(), 2.2, 1e-9);
  robot.yaw += 2.2 - 3.1;
  EXPECT_EQ(run(0.1).presence, Presence::kNobody) << "the rear camera looks there";
  robot.yaw += 3.1 - 0.1;
  EXPECT_EQ(run(0.1).presence, Presence::kNobody) << "the Kinect looks there";
  robot.yaw += 0.1 - 1.2;
  run(0.1);
  EXPECT_TRUE(sees(1)) << "where only the laser looks nobody notices who stands";
  run(52.0);
  EXPECT_EQ(estimate.presence, Presence::kNobody) << "for some time only";
}

TEST_F(OnTheWay, WhoStandsAtARobotThatTurnsMayHaveSteppedAside) {
  guide();
  drives = 0.0;
  person(1).velocity = {0, 0};
  put(1, 1.0, 2.7);  // just in the rear camera's view
  run(0.1);
  hide(1);
  run(0.6);
  EXPECT_TRUE(sees(1));
  drives = 1.0;
  run(1.5);
  EXPECT_EQ(estimate.presence, Presence::kNobody) << "he would have come out behind it";
}

TEST_F(OnTheWay, WhoWasWalkingOffHasNotSteppedAside) {
  guide();
  drives = 0.0;
  person(1).velocity = {1.2, 0.0};
  run(0.3);
  hide(1);
  EXPECT_EQ(run(0.1).presence, Presence::kNobody);
}

TEST_F(OnTheWay, HisNumberGivenToSomebodyElsewhereIsNotHis) {
  guide();
  drives = 0.0;
  person(1).velocity = {0, 0};
  put(1, 1.0, 2.2);
  run(0.1);
  Person other = person(1);
  hide(1);
  run(2.0);
  other.position = robot.position() + Point2(4.0, 0.5);
  other.velocity = {1.0, 0.0};
  people.push_back(other);
  run(0.2);
  EXPECT_EQ(estimate.presence, Presence::kSeen);
  EXPECT_EQ(estimate.person, 0U);
  EXPECT_NEAR(estimate.place.norm(), 1.0, 1e-9) << "where he was";
  add(8, robot.position() + Point2(0.9, -0.4));
  run(0.1);
  EXPECT_TRUE(sees(8));
}

TEST_F(OnTheWay, WhoComesOutFromWhereNothingLooksIsTheVisitor) {
  guide();
  drives = 0.0;
  person(1).velocity = {0, 0};
  const double bearing = geometry::kPi - 2.2;
  person(1).position = robot.position() + 1.2 * Point2(std::cos(bearing), std::sin(bearing));
  run(0.1);
  const Point2 there = person(1).position;
  hide(1);
  run(8.0);
  add(9, there + Point2(0.3, 0.2), {0.4, 0.2});
  run(0.1);
  EXPECT_TRUE(sees(9));
}

TEST_F(OnTheWay, WhoComesBackToWhereNothingLooksIsTheVisitor) {
  guide();
  drives = 0.0;
  hide(1);
  run(4.0);
  const double bearing = geometry::kPi - 2.2;
  add(9, robot.position() + 1.2 * Point2(std::cos(bearing), std::sin(bearing)));
  run(0.3);
  for (int i = 0; i < 12; ++i) {
    person(9).unseen = 0.5 * i;
    run(0.5);
  }
  EXPECT_TRUE(sees(9));
}

TEST_F(OnTheWay, ARobotThatDrivesOnMissesWhoStayedWhereNothingLooked) {
  guide();
  person(1).velocity = {0, 0};
  const double bearing = geometry::kPi - 2.2;
  person(1).position = robot.position() + 1.2 * Point2(std::cos(bearing), std::sin(bearing));
  run(0.1);
  hide(1);
  run(1.5);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
}

TEST_F(OnTheWay, WhoPassesARobotThatWaitsIsNot) {
  lose_far_behind();
  run(3.0);
  add(6, robot.position() + Point2(4.0, 0.9), {-1.1, 0.0});
  for (int i = 0; i < 60; ++i) {
    run(0.1);
    EXPECT_NE(estimate.presence, Presence::kSeen) << i;
  }
}

TEST_F(OnTheWay, HiddenForAMomentIsNoLoss) {
  guide();
  person(1).unseen = 0.4;
  run(0.1);
  EXPECT_TRUE(sees(1));
}

TEST_F(OnTheWay, AnotherNumberAtTheSamePlaceIsTheSameVisitor) {
  guide();
  const Point2 there = person(1).position;
  hide(1);
  run(0.4);
  add(5, there + Point2(-0.4, 0.1), {-1.0, 0.0});
  run(0.1);
  EXPECT_TRUE(sees(5));
}

TEST_F(OnTheWay, WhoCrossesWhereTheVisitorWasHiddenIsNot) {
  guide();
  const Point2 there = person(1).position;
  hide(1);
  add(5, there + Point2(0.0, -0.5), {0.0, 1.2});
  for (int i = 0; i < 20; ++i) {
    run(0.1);
    EXPECT_NE(estimate.person, 5U);
  }
}

TEST_F(OnTheWay, WhoComesTowardAndPassesIsNot) {
  guide();
  hide(1);
  add(5, robot.position() + Point2(-4.0, 0.8), {1.2, 0.0});
  for (int i = 0; i < 60; ++i) {
    run(0.1);
    EXPECT_NE(estimate.presence, Presence::kSeen) << i;
  }
}

TEST_F(OnTheWay, WhoComesUpToTheFrontOfARobotThatWaitsIsNot) {
  lose_far_behind();
  run(2.0);
  add(5, robot.position() + Point2(-2.2, 0.0), {0.8, 0.0});
  for (int i = 0; i < 19; ++i) {
    run(0.1);
    EXPECT_NE(estimate.presence, Presence::kSeen) << i;
  }
}

TEST_F(OnTheWay, WhoWalksAlongFarBesideIsNot) {
  guide();
  hide(1);
  run(2.0);
  add(5, robot.position() + Point2(1.5, 2.8), {-1.0, 0.0});
  EXPECT_EQ(run(3.0).presence, Presence::kNobody);
}

TEST_F(OnTheWay, LongAfterALossSomebodyAtThatPlaceIsNot) {
  guide();
  const Point2 there = person(1).position;
  hide(1);
  run(3.0);
  add(6, there + Point2(-0.8, 0.0), {-1.0, 0.0});
  EXPECT_EQ(run(0.2).presence, Presence::kNobody);
}

TEST_F(OnTheWay, WhoStandsBesideTheWayIsNot) {
  guide();
  hide(1);
  add(5, robot.position() + Point2(-1.0, 1.3));
  run(5.0);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
}

TEST_F(OnTheWay, AVisitorWithABrokenIdentityIsFoundByFollowing) {
  guide();
  const Point2 there = person(1).position;
  hide(1);
  run(2.5);  // hidden behind others
  add(6, there + Point2(-1.5, 0.4), {-1.1, 0.0});
  run(0.4);
  EXPECT_NE(estimate.presence, Presence::kSeen) << "not at once";
  run(0.6);
  EXPECT_TRUE(sees(6));
}

TEST_F(OnTheWay, WhoIsClearlyShorterIsNotAndWhoIsTallerOnlyAfterAWhile) {
  const auto found = [this](double tall, double after) {
    tracker = VisitorTracker({});
    people.clear();
    robot = {};
    service = Service::kNobody;
    height = 1.75;
    guide();
    hide(1);
    run(after);
    height = tall;
    add(6, robot.position() + Point2(2.0, 0.4), {-1.1, 0.0});
    run(1.0);
    return sees(6);
  };
  EXPECT_TRUE(found(1.80, 2.5));
  EXPECT_TRUE(found(kNan, 2.5));
  EXPECT_FALSE(found(1.55, 2.5));
  EXPECT_FALSE(found(1.55, 9.0));
  EXPECT_FALSE(found(1.95, 2.5));
  EXPECT_TRUE(found(1.95, 9.0)) << "he may have bent over the tablet all the time";
}

TEST_F(OnTheWay, WhoWearsSomethingElseIsNotHoweverHeFollowsOrWaits) {
  const auto found = [this](const imaging::Appearances& other, bool waits) {
    tracker = VisitorTracker({});
    people.clear();
    robot = {};
    service = Service::kNobody;
    drives = 0.0;
    worn = {in(kRed), in(kRed)};
    guide();
    hide(1);
    run(2.5);
    worn = other;
    if (waits) drives = 0.0;
    add(6, robot.position() + Point2(waits ? 1.5 : 2.0, 0.4), {waits ? 0.0 : -1.1, 0.0});
    run(waits ? 10.0 : 1.0);
    return sees(6);
  };
  for (const bool waits : {false, true}) {
    EXPECT_TRUE(found({in(kRed), in(kRed)}, waits));
    EXPECT_TRUE(found({}, waits)) << "nothing is known of his clothes";
    EXPECT_FALSE(found({imaging::Appearance{}, in(kNavy)}, waits));
  }
}

TEST_F(OnTheWay, WhoWearsTheSameIsFoundAgainSooner) {
  const auto found_after = [this](const imaging::Appearances& clothes, bool waits) {
    tracker = VisitorTracker({});
    people.clear();
    robot = {};
    service = Service::kNobody;
    drives = 0.0;
    worn = {in(kRed), in(kRed)};
    guide();
    hide(1);
    run(2.5);
    worn = clothes;
    if (waits) drives = 0.0;
    add(6, robot.position() + Point2(waits ? 1.5 : 2.0, 0.4), {waits ? 0.0 : -1.1, 0.0});
    const double since = time;
    while (!sees(6) && time < since + 10.0) run(kStep);
    return time - since;
  };
  for (const bool waits : {false, true}) {
    const double unknown = found_after({}, waits);
    EXPECT_LT(found_after({imaging::Appearance{}, in(kRed)}, waits), 0.7 * unknown);
    imaging::Appearance legs = in(kRed);
    legs.upper = {};
    EXPECT_NEAR(found_after({imaging::Appearance{}, legs}, waits), unknown, 1e-6)
        << "many wear jeans";
  }
}

TEST_F(OnTheWay, WhoWasSeenByTheKinectIsKnownByTheRearCameraToo) {
  worn = {in(kRed), {}};
  guide();
  hide(1);
  run(2.5);
  worn = {imaging::Appearance{}, in(kNavy)};
  add(6, robot.position() + Point2(2.0, 0.4), {-1.1, 0.0});
  run(1.0);
  EXPECT_FALSE(sees(6));
  worn = {imaging::Appearance{}, in({45.0, 45.0, 24.0})};  // red in another camera's colors
  add(7, robot.position() + Point2(2.0, -0.4), {-1.1, 0.0});
  run(1.0);
  EXPECT_TRUE(sees(7));
}

TEST_F(OnTheWay, HisNumberGivenToSomebodyInOtherClothesIsNotHis) {
  worn = {in(kRed), in(kRed)};
  guide();
  const Point2 there = person(1).position;
  person(1).appearances[1] = in(kNavy);
  run(0.3);
  EXPECT_TRUE(sees(1)) << "a moment says little";
  run(1.5);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
  EXPECT_EQ(estimate.person, 0U);
  add(6, there + Point2(-2.0, 0.3), {-1.1, 0.0});
  run(1.0);
  EXPECT_TRUE(sees(6)) << "he himself";
}

TEST_F(OnTheWay, WhoGotHisNumberComesWithHisLookToTheKinectOnly) {
  worn = {in(kRed), {}};
  guide();
  person(1).appearances[1] = in(kNavy);
  run(0.3);
  EXPECT_TRUE(sees(1)) << "a moment says little";
  run(1.5);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
}

TEST_F(OnTheWay, TheOtherCameraMayShowHisClothesInItsColors) {
  worn = {in(kRed), {}};
  guide();
  person(1).appearances[1] = in({45.0, 45.0, 24.0});
  run(2.0);
  EXPECT_TRUE(sees(1));
}

TEST_F(OnTheWay, OtherLightMakesNobodyElseOfHim) {
  worn = {in(kRed), in(kRed)};
  guide();
  for (int i = 0; i < 60; ++i) {
    person(1).appearances[1].upper.color.lightness += 0.5;
    person(1).appearances[1].upper.color.a += 0.3;
    run(0.5);
    ASSERT_TRUE(sees(1)) << i;
  }
}

TEST_F(OnTheWay, SomebodyMistakenForTheVisitorIsLeftWhenHisClothesAreSeen) {
  worn = {in(kRed), in(kRed)};
  guide();
  hide(1);
  run(2.0);
  worn = {};
  add(6, robot.position() + Point2(2.0, 0.4), {-1.0, 0.0});
  run(1.0);
  ASSERT_TRUE(sees(6));
  person(6).appearances[1] = in(kNavy);
  run(1.0);
  EXPECT_FALSE(sees(6));
}

TEST_F(OnTheWay, SomebodyTooFarFromWhereTheVisitorWasIsNot) {
  guide();
  hide(1);
  run(0.7);
  drives = 0.0;
  add(6, robot.position() + Point2(5.8, 0.0), {-0.5, 0.0});
  run(0.8);
  EXPECT_NE(estimate.person, 6U);
}

TEST_F(OnTheWay, TheFirstIdentityCountsWhenItComesBack) {
  guide();
  Person first = person(1);
  hide(1);
  run(2.0);
  add(6, first.position + Point2(-1.5, 0.4), {-1.0, 0.0});
  run(1.0);
  ASSERT_TRUE(sees(6));
  first.position = robot.position() + Point2(1.5, 0.0);
  people.push_back(first);
  run(0.1);
  EXPECT_TRUE(sees(1));
}

TEST_F(OnTheWay, SomebodyMistakenForTheVisitorIsLeftForTheOneWhoFollows) {
  guide();
  hide(1);
  run(2.0);
  add(6, robot.position() + Point2(2.0, 0.4), {-1.0, 0.0});
  run(1.0);
  ASSERT_TRUE(sees(6));
  add(8, robot.position() + Point2(1.0, 0.0), {-1.0, 0.0});
  run(2.0);
  ASSERT_TRUE(sees(6)) << "both follow";
  hide(8);
  person(6).velocity = {0, 0};
  run(1.0);
  EXPECT_TRUE(sees(6)) << "may tie a lace";
  add(7, robot.position() + Point2(1.5, -0.3), {-1.0, 0.0});
  run(2.0);
  EXPECT_TRUE(sees(7));
}

TEST_F(OnTheWay, AVisitorWhoTiesALaceIsNotLeftForWhoeverWalksBehind) {
  guide();
  person(1).velocity = {0, 0};
  add(7, robot.position() + Point2(1.0, -0.3), {-1.0, 0.0});
  run(3.0);
  EXPECT_TRUE(sees(1));
}

TEST_F(OnTheWay, WhoStandsBehindARobotThatWaitsIsFoundAgain) {
  lose_far_behind();
  run(3.0);
  add(6, robot.position() + Point2(1.3, 0.0));
  run(4.0);  // who cannot pass waits, too, and turns round
  EXPECT_NE(estimate.presence, Presence::kSeen);
  person(6).velocity = {0.0, 0.4};  // as the tracker has it of somebody so near, who only stands
  person(6).position -= Point2(0.0, 0.2);
  run(1.5);
  EXPECT_TRUE(sees(6));
}

TEST_F(OnTheWay, WhoCameFromAheadOrWasSeenBesideTheVisitorMustWaitLonger) {
  guide();
  person(1).velocity = {0, 0};
  add(5, person(1).position + Point2(0.0, 1.0));
  run(3.0);
  drives = 0.0;
  hide(1);
  add(6, robot.position() + Point2(-1.5, 0.5), {1.5, 0.0});
  run(1.5);
  person(6).velocity = {0, 0};
  person(5).position = robot.position() + Point2(1.0, -0.5);
  EXPECT_EQ(run(5.5).presence, Presence::kNobody);
  hide(6);
  run(1.0);
  EXPECT_TRUE(sees(5));
}

TEST_F(OnTheWay, WhoWasLostNearTheRobotIsFoundAgainSooner) {
  guide();
  person(1).velocity = {1.2, 0.0};
  drives = 0.0;
  run(0.4);
  hide(1);
  run(2.0);
  ASSERT_EQ(estimate.presence, Presence::kNobody);
  add(6, robot.position() + Point2(1.3, -0.9));
  run(3.3);
  EXPECT_TRUE(sees(6));
}

TEST_F(OnTheWay, SomebodyWhoFollowedBesideTheVisitorIsNotTakenForHim) {
  guide();
  add(5, person(1).position + Point2(-0.2, 0.9), {-1.0, 0.0});
  run(3.0);
  hide(1);
  EXPECT_EQ(run(3.0).presence, Presence::kNobody);
}

TEST_F(OnTheWay, SomebodyMistakenForTheVisitorWhoWalksOnAheadIsLeft) {
  guide();
  hide(1);
  run(2.0);
  add(6, robot.position() + Point2(2.0, 0.4), {-1.0, 0.0});
  run(1.0);
  ASSERT_TRUE(sees(6));
  person(6).position = robot.position() + Point2(-1.5, 0.8);
  person(6).velocity = {-1.5, 0.0};
  run(2.0);
  EXPECT_EQ(estimate.presence, Presence::kNobody);
}

TEST_F(OnTheWay, WhereSomebodyMistakenForTheVisitorWentNobodyIsSupposed) {
  guide();
  hide(1);
  run(2.0);
  add(6, robot.position() + Point2(2.0, 0.4), {-1.0, 0.0});
  run(1.0);
  ASSERT_TRUE(sees(6));
  drives = 0.0;
  person(6).position = robot.position() + Point2(-1.1, 0.8);
  person(6).velocity = {0.0, 0.0};
  run(2.0);
  hide(6);
  EXPECT_EQ(run(2.0).presence, Presence::kNobody);
}

TEST_F(OnTheWay, AfterALongWaitTheVisitorMayComeFromAnywhere) {
  guide();
  drives = 0.0;
  person(1).velocity = {2.0, 0.0};
  run(4.0);
  hide(1);
  run(6.0);
  add(6, robot.position() + Point2(1.2, 0.0));
  run(5.5);
  EXPECT_TRUE(sees(6));
}

TEST_F(OnTheWay, RoundACornerTheVisitorIsStillBehind) {
  guide();
  robot.yaw =
      geometry::kPi / 2;  // the robot has turned right and drives on; the visitor comes later
  run(1.2);
  person(1).velocity = {0.0, 1.0};
  run(2.0);
  EXPECT_TRUE(sees(1));
  const Point2 there = person(1).position;
  hide(1);
  run(2.0);
  add(9, there + Point2(0.2, 1.8), {0.0, 1.0});
  run(1.0);
  EXPECT_TRUE(sees(9));
}

TEST_F(OnTheWay, WithoutEyesBehindTheVisitorIsUnknown) {
  guide();
  behind = false;
  EXPECT_EQ(run(0.2).presence, Presence::kUnknown);
  hide(1);
  EXPECT_EQ(run(3.0).presence, Presence::kUnknown);
  behind = true;
  EXPECT_EQ(run(0.2).presence, Presence::kNobody);
}

TEST_F(OnTheWay, WhoWasNotSeenWhenItBeganIsFoundByFollowing) {
  service = Service::kGuides;
  EXPECT_EQ(run(1.0).presence, Presence::kNobody);
  drives = 1.0;
  run(1.0);
  add(4, robot.position() + Point2(-1.2, 0.0), {1.0, 0.0});
  run(1.5);
  EXPECT_TRUE(sees(4));
}

}  // namespace
}  // namespace usher::visitor_tracker
