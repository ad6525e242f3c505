// What the component does when something that it reads is lost, late or wrong: the README's table.
#include <gmock/gmock.h>

#include <limits>
#include <vector>

#include "navigation/local_planner/shell/component.hpp"
#include "navigation/local_planner/shell/waypoint_follower.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::local_planner {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::FollowGoal_Constants;
using namespace usher_msgs::msg::GoalStatus_Constants;
constexpr const char* kFootprint = "robot.footprint: [0.3, 0.3, -0.3, 0.3, -0.3, -0.3, 0.3, -0.3]";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kWindow = "local_planner";
constexpr const char* kFollower = "waypoint_follower";

runtime::ComponentFactory factory_of(const std::string& type) {
  return type == kWindow ? runtime::component_factory<LocalPlannerComponent>(type)
                         : runtime::component_factory<WaypointFollowerComponent>(type);
}

/// A robot on a free floor whose base does at once what it is told; it stays where it is, so that
/// its path never ends. Everything that it reads can be left out or changed.
class Losses : public testing::TestWithParam<const char*> {
 protected:
  explicit Losses(const std::string& parameters = {})
      : host(factory_of(GetParam()), kFootprint + parameters) {}
  void run(int ms) {
    for (int at = 0; at < ms; at += 50) {
      if (transforms) host.publish(topics::kTf, frames_of_robot());
      if (odometry) host.publish(topics::kOdom, odom());
      usher_msgs::msg::NavigateStatus status;
      status.header(wire::header(host.now(), frames::kMap));
      host.publish(topics::kNavigateStatus, status);
      if (whiskers) {
        whiskers->header(wire::header(host.now(), frames::kBaseLink));
        host.publish(topics::kWhiskers, *whiskers);
      }
      if (!people.people().empty()) {
        people.header(wire::header(host.now() + people_ahead, frames::kOdom));
        host.world().publish(topics::kPeople, people, "people_detector", people_host);
        host.run_for(milliseconds(5));
      }
      host.publish(topics::kTfStatic, mount_of_laser());
      if (scans) host.publish(topics::kScanFiltered, scan());
      if (sees) {
        host.world().publish(topics::kLocalCosts,
                             wire::to_message(host.now() - costs_late, costs_frame, costs),
                             "costmap", costs_host);
      }
      host.run_for(milliseconds(people.people().empty() ? 50 : 45));
    }
  }
  tf2_msgs::msg::TFMessage frames_of_robot() const {
    tf2_msgs::msg::TFMessage moving;
    moving.transforms().push_back(
        wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint, geometry::Pose3{}));
    if (localized) {
      moving.transforms().push_back(
          wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::Pose3{}));
    }
    return moving;
  }
  tf2_msgs::msg::TFMessage mount_of_laser() const {
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "laser", geometry::Pose3{}));
    return fixed;
  }
  sensor_msgs::msg::LaserScan scan() const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now() - scan_late, "laser"));
    message.angle_min(-2.0F), message.angle_max(2.0F), message.angle_increment(0.01F);
    message.range_min(0.05F), message.range_max(4.0F);
    message.ranges(std::vector<float>(beams, range));
    return message;
  }
  nav_msgs::msg::Odometry odom() const {
    nav_msgs::msg::Odometry message;
    message.header(wire::header(host.now(), frames::kOdom));
    message.pose().pose(wire::to_message(pose));
    message.twist().twist(wire::to_message(host.now(), commanded()).twist());
    return message;
  }
  usher_msgs::msg::FollowGoal goal(std::uint8_t mode, float amount = 0.0F) {
    usher_msgs::msg::FollowGoal message;
    message.id(++goal_id);
    message.client("navigator");
    message.mode(mode);
    message.amount(amount);
    std::vector<geometry::Pose2> path;
    if (mode == MODE_PATH) path = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
    message.path(wire::to_message(host.now(), frames::kMap, path));
    return message;
  }
  void drive() {
    run(500);
    host.publish(topics::kFollowGoal, goal(MODE_PATH));
    run(1500);
  }
  void add_person(double x, double y, double vx, double vy) {
    usher_msgs::msg::Person person;
    person.id(people.people().size() + 1);
    person.x(x), person.y(y), person.vx(vx), person.vy(vy);
    people.people().push_back(person);
  }
  geometry::Twist2 commanded() const {
    const auto command = host.last(topics::kCmdVelNavigation);
    return command ? *wire::from_message(command->twist()) : geometry::Twist2{};
  }
  bool stands() const { return commanded() == geometry::Twist2{}; }
  bool drives() const { return commanded().v > 0.3; }
  usher_msgs::msg::FollowStatus status() const { return host.last(topics::kFollowStatus).value(); }
  void expect_waiting(const std::string& reason) {
    EXPECT_TRUE(stands());
    EXPECT_EQ(status().state(), STATE_WAITING);
    EXPECT_EQ(status().reason(), reason);
    EXPECT_EQ(host.heartbeat().reason(), reason);
  }

  grid::Grid<std::uint8_t> costs{{80, 80, 0.05, -2.0, -2.0}, 0};
  const char* costs_frame = frames::kOdom;
  geometry::Pose2 pose;
  milliseconds scan_late{0}, costs_late{0};
  bool transforms = true, localized = true, odometry = true, sees = true, scans = true;
  std::size_t beams = 401;
  float range = std::numeric_limits<float>::infinity();
  std::optional<usher_msgs::msg::Whiskers> whiskers;
  usher_msgs::msg::People people;
  milliseconds people_ahead{0};
  std::string people_host, costs_host;  // empty: its own
  runtime::TestHost host;
  std::uint64_t goal_id = 0;
};

class WindowLosses : public Losses {};
class FollowerLosses : public Losses {};
struct PeopleNeeded : Losses {
  PeopleNeeded() : Losses("\npeople_needed: true") {}
};
INSTANTIATE_TEST_SUITE_P(All, Losses, testing::Values(kWindow, kFollower));
INSTANTIATE_TEST_SUITE_P(People, WindowLosses, testing::Values(kWindow));
INSTANTIATE_TEST_SUITE_P(People, PeopleNeeded, testing::Values(kWindow, kFollower));
INSTANTIATE_TEST_SUITE_P(Scans, FollowerLosses, testing::Values(kFollower));

TEST_P(Losses, StandsWithoutCostsAndGoesOnWithThem) {
  drive();
  ASSERT_TRUE(drives());
  sees = false;
  run(200);
  EXPECT_TRUE(drives()) << "some may be late";
  run(200);
  expect_waiting("no local costs");
  sees = true;
  run(1500);
  EXPECT_TRUE(drives());
  EXPECT_EQ(status().state(), STATE_ACTIVE);
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_P(Losses, StandsOnCostsThatComeTooLate) {
  drive();
  ASSERT_TRUE(drives());
  costs_late = milliseconds(300);
  run(500);
  expect_waiting("no local costs");
  host.clear();
  run(500);
  EXPECT_TRUE(host.written(topics::kCmdVelNavigation).empty());
}

TEST_P(Losses, StandsOnCostsThatAreNone) {
  drive();
  costs_frame = frames::kMap;
  run(200);
  expect_waiting("local costs refused");
  EXPECT_GE(host.counter("inputs: rejected"), 2U);
  costs_frame = frames::kOdom;
  run(1500);
  EXPECT_TRUE(drives());
}

TEST_P(Losses, StandsOnCostsThatDoNotHoldTheRobot) {
  drive();
  pose = {50.0, 0.0, 0.0};
  run(200);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_EQ(status().reason(), to_string(Reason::kInvalidInput));
}

TEST_P(Losses, RollsOutOnItsArcOnCostsThatDoNotHoldTheRobot) {
  pose = {0.0, 0.0, -0.3};  // beside its path, and stays so
  drive();
  const geometry::Twist2 before = commanded();
  if (GetParam() == kFollower) return;  // turns on the spot
  ASSERT_GT(before.v, 0.1);
  ASSERT_GT(before.w, 0.1);
  pose = {50.0, 0.0, -0.3};
  run(50);
  EXPECT_EQ(commanded().v, 0.0);
  EXPECT_NEAR(commanded().w, before.w, 1e-3);
}

TEST_P(Losses, StandsWithoutOdometryAndGoesOnWithIt) {
  drive();
  ASSERT_TRUE(drives());
  odometry = false;
  run(250);
  expect_waiting("no odometry");
  odometry = true;
  run(1500);
  EXPECT_TRUE(drives());
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_P(Losses, StandsOnOdometryThatIsNotANumber) {
  drive();
  pose.x = kNan;
  run(200);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_GE(host.counter("inputs: rejected"), 2U);
  pose.x = 0.0;
  run(1500);
  EXPECT_TRUE(drives());
}

TEST_P(Losses, StandsUntilTheRobotIsLocalized) {
  localized = false;
  drive();
  expect_waiting("robot not localized");
  localized = true;
  run(1500);
  EXPECT_TRUE(drives());
}

TEST_P(Losses, DrivesOnWithTheLastCorrectionOfASilentLocalization) {
  drive();
  transforms = false;
  run(2000);
  EXPECT_TRUE(drives()) << "in odom; the supervisor stops the robot without localization";
}

TEST_P(WindowLosses, GivesWayToSomebody) {
  drive();
  add_person(1.0, 0.0, 0.0, 0.0);
  run(600);
  EXPECT_EQ(status().reason(), to_string(Reason::kGivingWay));
}

TEST_P(Losses, DrivesCarefullyWhenPeopleFallSilent) {
  drive();
  run(1000);
  const double unaware = commanded().v;  // nobody on this robot tells of people
  ASSERT_GT(unaware, DynamicWindowConfig{}.careful_speed + 0.2);
  add_person(-20.0, 0.0, 0.0, 0.0);
  run(1000);
  EXPECT_NEAR(commanded().v, unaware, 0.01);
  people.people().clear();  // and nobody tells of them
  run(3000);
  EXPECT_NEAR(commanded().v, DynamicWindowConfig{}.careful_speed, 0.01);
  EXPECT_EQ(host.heartbeat().reason(), "nobody tells of people: drives slowly");
  add_person(-20.0, 0.0, 0.0, 0.0);
  run(3000);
  EXPECT_NEAR(commanded().v, unaware, 0.01);
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_P(PeopleNeeded, DrivesCarefullyUntilSomebodyTellsOfPeople) {
  drive();
  run(1000);
  EXPECT_NEAR(commanded().v, DynamicWindowConfig{}.careful_speed, 0.01);
  add_person(-20.0, 0.0, 0.0, 0.0);
  run(3000);
  EXPECT_GT(commanded().v, DynamicWindowConfig{}.careful_speed + 0.2);
}

TEST_P(WindowLosses, RemembersWhoWasLastSeenWhereTheLaserIsBlind) {
  drive();
  add_person(1.0, 0.0, 0.0, 0.0);
  people.people().back().unseen(3.0F);
  run(600);
  const double beside = commanded().v;
  people.people().back().x(2.0);  // farther away it would be seen
  run(1500);
  EXPECT_GT(commanded().v, beside + 0.1);
}

TEST_P(WindowLosses, LeavesOutPeopleWhoAreNone) {
  drive();
  add_person(kNan, 0.0, 0.0, 0.0);
  add_person(1.0, 0.0, kNan, 0.0);
  run(600);
  EXPECT_TRUE(drives());
}

TEST_P(WindowLosses, JudgesNoOtherHostsPeopleByItsOwnClock) {
  drive();
  people_host = "vision";
  people_ahead = milliseconds(-2500);  // that host's clock is behind
  add_person(3.5, 0.0, -0.9, 0.0);     // in 2.5 s they would be before the robot
  run(600);
  EXPECT_NE(status().reason(), to_string(Reason::kGivingWay));
}

TEST_P(Losses, TellsNobodyOfItsHostTheStampOfAnotherHostsCosts) {
  costs_host = "mapping";
  costs_late = milliseconds(2500);  // that host's clock is behind
  drive();
  EXPECT_TRUE(drives());
  const auto age =
      host.now() - wire::from_message(host.last(topics::kCmdVelNavigation)->header().stamp());
  EXPECT_LT(age, milliseconds(100)) << "who reads the command ages it by that";
}

TEST_P(Losses, TakesNothingForTouchedWhenTheWhiskersAreSilent) {
  run(500);
  whiskers.emplace();
  whiskers->front_left(true);
  whiskers->back_right(true);
  host.publish(topics::kFollowGoal, goal(MODE_ROTATE, 1.5F));
  run(1000);
  EXPECT_TRUE(stands()) << "bent whiskers bar the turn to the left";
  EXPECT_EQ(status().state(), STATE_WAITING);
  whiskers.reset();
  run(800);
  EXPECT_GT(commanded().w, 0.1);
}

TEST_P(Losses, RefusesGoalsThatAreNone) {
  run(500);
  auto nowhere = goal(MODE_PATH);
  nowhere.path().poses().front().pose().position().x(kNan);
  auto empty = goal(MODE_PATH);
  empty.path().poses().clear();
  auto elsewhere = goal(MODE_PATH);
  elsewhere.path().header().frame_id(frames::kOdom);
  auto senseless = goal(99);
  auto endless = goal(MODE_PATH);
  endless.max_speed(std::numeric_limits<float>::infinity());
  for (const auto& none : {nowhere, empty, elsewhere, senseless, endless})
    host.publish(topics::kFollowGoal, none);
  run(500);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().id(), 0U);
  EXPECT_EQ(host.counter("inputs: rejected"), 5U);
}

TEST_P(Losses, StandsWhenItIsCancelled) {
  drive();
  usher_msgs::msg::GoalCancel cancel;
  cancel.id(goal_id);
  cancel.client("navigator");
  host.publish(topics::kFollowCancel, cancel);
  run(100);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().state(), STATE_CANCELLED);
}

TEST_P(FollowerLosses, LateScansAreNone) {
  drive();
  ASSERT_TRUE(drives());
  scan_late = milliseconds(500);
  run(500);
  expect_waiting("no scan");
}

TEST_P(FollowerLosses, StandsWithoutAScanAndGoesOnWithIt) {
  drive();
  ASSERT_TRUE(drives());
  scans = false;
  run(200);
  EXPECT_TRUE(drives()) << "some may be late";
  run(200);
  expect_waiting("no scan");
  run(500);
  expect_waiting("no scan");
  scans = true;
  run(1500);
  EXPECT_TRUE(drives());
  EXPECT_EQ(host.heartbeat().reason(), "");
}

TEST_P(FollowerLosses, StandsOnScansThatAreNone) {
  drive();
  beams = 17;  // not as many as the angles say
  run(600);
  expect_waiting("no scan");
  EXPECT_GE(host.counter("inputs: rejected"), 5U);
  beams = 401;
  run(1500);
  EXPECT_TRUE(drives());
}

TEST_P(FollowerLosses, StandsWhereItsSectorsAreBlind) {
  drive();
  range = std::numeric_limits<float>::quiet_NaN();
  run(1500);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_EQ(status().reason(), to_string(Reason::kBlocked));
}

TEST_P(FollowerLosses, StandsBeforeWhatIsNearerThanTheSafeDistance) {
  drive();
  range = 0.45F;
  run(1500);
  EXPECT_TRUE(stands());
  EXPECT_EQ(status().state(), STATE_WAITING);
  EXPECT_NEAR(status().obstacle_distance(), 0.45F, 1e-3);
  EXPECT_GT(status().blocked_for(), 0.2F);
  range = 3.0F;
  run(1500);
  EXPECT_TRUE(drives());
}

}  // namespace
}  // namespace usher::local_planner
