#include "perception/visitor_tracker/shell/component.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "runtime/testing/test_host.hpp"
#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::visitor_tracker {
namespace {

using std::chrono::milliseconds;
namespace presence = usher_msgs::msg::Visitor_Constants;

struct Bench {
  runtime::TestHost host{runtime::component_factory<VisitorTrackerComponent>("visitor_tracker")};
  geometry::Pose2 odom_T_base{2.0, 1.0, 0.0};
  double x = 3.5, y = 1.0;  // of the person in odom
  bool people = true, odometry = true, serves = false, guides = false, follows = false,
       guide = true;
  bool ahead = true, behind = true;
  float unseen = 0.0F;
  imaging::LabColor shirt{37.0, 52.0, 30.0};

  void run(int ms) {
    for (int i = 0; i < ms; i += 50) {
      if (guide && i % 500 == 0) {
        usher_msgs::msg::GuideStatus status;
        status.header(wire::header(host.now(), ""));
        status.serves(serves);
        status.guides(guides);
        status.follows(follows);
        host.publish(topics::kGuideStatus, status);
      }
      nav_msgs::msg::Odometry odom;
      odom.header(wire::header(host.now(), frames::kOdom));
      odom.pose().pose(wire::to_message(odom_T_base));
      if (odometry) host.publish(topics::kOdom, odom);
      host.run_for(milliseconds(5));
      usher_msgs::msg::People message;
      message.header(wire::header(host.now(), frames::kOdom));
      message.kinect_looks(ahead);
      message.rear_looks(behind);
      auto& person = message.people().emplace_back();
      person.id(5);
      person.x(x);
      person.y(y);
      person.age(100.0F);
      person.unseen(unseen);
      person.rear_appearance(wire::to_message(imaging::Appearance{{shirt, 5}, {}}));
      if (people) host.publish(topics::kPeople, message);
      host.run_for(milliseconds(45));
    }
  }
  usher_msgs::msg::Visitor last() const { return host.last(topics::kVisitor).value(); }
};

TEST(VisitorTrackerShell, TellsWhoStandsBeforeTheRobotInItsFrame) {
  Bench bench;
  bench.run(1000);
  const auto visitor = bench.last();
  EXPECT_EQ(visitor.presence(), presence::PRESENCE_SEEN);
  EXPECT_EQ(visitor.person(), 5U);
  EXPECT_EQ(visitor.header().frame_id(), frames::kBaseFootprint);
  EXPECT_NEAR(visitor.x(), 1.5, 1e-9);
  EXPECT_NEAR(visitor.y(), 0.0, 1e-9);
  EXPECT_EQ(visitor.speed(), 0.0F);
  EXPECT_GE(bench.host.written(topics::kVisitor).size(), 10U);
}

TEST(VisitorTrackerShell, TheStampIsThatOfThePeopleThoughTheVisitorIsHiddenForAMoment) {
  Bench bench;
  bench.run(1000);
  bench.unseen = 0.45F;
  bench.run(50);
  ASSERT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  const auto age = bench.host.now() - wire::from_message(bench.last().header().stamp());
  EXPECT_LE(age, milliseconds(60)) << "an older one would be taken for silence";
}

TEST(VisitorTrackerShell, WithTheGuideOnTheWayItKeepsWhoFollows) {
  Bench bench;
  bench.run(1000);
  bench.serves = bench.guides = true;
  bench.odom_T_base.yaw = geometry::kPi;
  bench.run(1000);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  EXPECT_NEAR(bench.last().x(), -1.5, 1e-9);
  bench.behind = false;
  bench.run(100);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_UNKNOWN) << "nobody looks behind";
}

TEST(VisitorTrackerShell, WhomTheRobotFollowsStaysTheVisitorFarAway) {
  Bench bench;
  bench.run(1000);
  bench.serves = bench.follows = true;
  bench.run(600);
  bench.x = 8.0;
  bench.run(1000);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  EXPECT_NEAR(bench.last().x(), 6.0, 1e-9);
}

TEST(VisitorTrackerShell, NobodyAndUnknownAreTwoThings) {
  Bench bench;
  bench.x = 40.0;
  bench.run(1000);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_NOBODY);
  bench.ahead = false;
  bench.run(200);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_UNKNOWN);
  EXPECT_TRUE(std::isnan(bench.last().speed()));
}

TEST(VisitorTrackerShell, WithoutPeopleOrOdometryTheVisitorIsUnknown) {
  Bench bench;
  bench.run(1000);
  ASSERT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  EXPECT_EQ(bench.host.heartbeat().reason(), "");
  bench.people = false;
  bench.run(600);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_UNKNOWN);
  EXPECT_EQ(bench.host.heartbeat().reason(), "nobody says who is around");
  bench.people = true;
  bench.odometry = false;
  bench.run(600);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_UNKNOWN);
  EXPECT_EQ(bench.host.heartbeat().reason(), "no odometry");
  bench.odometry = true;
  bench.run(1000);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
}

TEST(VisitorTrackerShell, WhoHasHisNumberInOtherClothesIsAnother) {
  Bench bench;
  bench.run(1000);
  bench.serves = bench.guides = true;
  bench.odom_T_base.yaw = geometry::kPi;
  bench.run(1000);
  ASSERT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  bench.shirt = {18.0, 4.0, -20.0};
  bench.run(1000);
  EXPECT_EQ(bench.last().person(), 0U);
}

TEST(VisitorTrackerShell, WithoutTheGuideItLooksForWhoStandsBeforeTheRobot) {
  Bench bench;
  bench.run(1000);
  bench.serves = bench.guides = true;
  bench.odom_T_base.yaw = geometry::kPi;
  bench.run(1000);
  ASSERT_EQ(bench.last().presence(), presence::PRESENCE_SEEN);
  bench.guide = false;
  bench.run(4000);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_NOBODY) << "stands behind";
}

TEST(VisitorTrackerShell, LeavesOutAndCountsPeopleWhoAreNowhere) {
  Bench bench;
  bench.x = std::numeric_limits<double>::quiet_NaN();
  bench.run(1100);
  EXPECT_EQ(bench.last().presence(), presence::PRESENCE_NOBODY);
  EXPECT_GT(bench.host.counter("people: rejected"), 10U);
}

}  // namespace
}  // namespace usher::visitor_tracker
