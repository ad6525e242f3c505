#include "perception/visitor_tracker/core/visitor_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace usher::visitor_tracker {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr double kStep = 1.0 / 15.0;  // [s]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A robot and the people that its tracker knows, at 15 Hz; each person walks at a velocity.
class Scene : public testing::Test {
 protected:
  Person& add(std::uint64_t id, const Point2& at, const Point2& velocity = {0, 0}) {
    return people.emplace_back(Person{
        .id = id, .position = at, .velocity = velocity, .height = height, .appearances = worn});
  }
  Person& person(std::uint64_t id) {
    for (Person& each : people) {
      if (each.id == id) return each;
    }
    ADD_FAILURE() << "nobody is " << id;
    return people.front();
  }
  void hide(std::uint64_t id) {
    std::erase_if(people, [&](const Person& each) { return each.id == id; });
  }
  const Estimate& once() {
    return estimate = tracker.update({time, robot, service, people, ahead, behind});
  }
  const Estimate& run(double seconds) {
    for (double end = time + seconds - 1e-9; time < end;) {
      time += kStep;
      robot.x += kStep * drives * std::cos(robot.yaw);
      robot.y += kStep * drives * std::sin(robot.yaw);
      for (Person& each : people) each.position += kStep * each.velocity;
      once();
    }
    return estimate;
  }
  /// The visitor 1 stood before the robot, which has turned away and leads; 1.2 m between them.
  void guide() {
    add(1, {1.2, 0.0});
    run(1.0);
    ASSERT_EQ(estimate.person, 1U);
    service = Service::kTalks;
    run(1.0);
    service = Service::kGuides;
    robot.yaw = geometry::kPi;
    run(0.5);
    drives = 1.0;
    person(1).velocity = {-1.0, 0.0};
    run(4.0);
    ASSERT_TRUE(sees(1));
  }
  /// The visitor 1 stood before the robot, which follows him; 1.5 m between them.
  void follow() {
    add(1, {1.5, 0.0});
    run(1.0);
    ASSERT_EQ(estimate.person, 1U);
    service = Service::kTalks;
    run(1.0);
    service = Service::kFollows;
    drives = 1.0;
    person(1).velocity = {1.0, 0.0};
    run(4.0);
    ASSERT_TRUE(sees(1));
  }
  /// The visitor 1 has stayed 4 m behind and is not seen any more; the robot waits.
  void lose_far_behind() {
    guide();
    person(1).velocity = {0, 0};
    run(3.0);
    drives = 0.0;
    hide(1);
  }
  void put(std::uint64_t id, double range, double bearing) {
    person(id).position = robot.position() + range * Point2(std::cos(robot.yaw + bearing),
                                                            std::sin(robot.yaw + bearing));
  }
  bool sees(std::uint64_t id) const {
    return estimate.presence == Presence::kSeen && estimate.person == id;
  }

  VisitorTracker tracker{{}};
  std::vector<Person> people;
  Pose2 robot;
  Service service = Service::kNobody;
  bool ahead = true, behind = true;
  double time = 100.0, drives = 0.0;
  double height = kNan;       ///< of whoever is added
  imaging::Appearances worn;  ///< likewise
  Estimate estimate;
};

/// As a camera shows a shirt of that color over jeans.
imaging::Appearance in(const imaging::LabColor& shirt) {
  return {{shirt, 5}, {{28.0, 2.0, -21.0}, 5}};
}
constexpr imaging::LabColor kRed{37.0, 52.0, 30.0}, kNavy{18.0, 4.0, -20.0};

class BeforeTheRobot : public Scene {};
class OnTheWay : public Scene {};
class Following : public Scene {};
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
