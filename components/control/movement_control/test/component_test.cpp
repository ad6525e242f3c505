// The rows of the README's table of losses, through the ports.
#include "control/movement_control/shell/component.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::movement_control {
namespace {

using std::chrono::milliseconds;

constexpr const char* kRobot = R"(
robot.footprint: [0.3, 0.3, -0.2, 0.3, -0.2, -0.3, 0.3, -0.3]
robot.laser.mount_x: 0.28 m
assume_person_ahead: false
)";

constexpr const char* kManifest = R"(
manifest.components:
  - {name: supervisor, type: supervisor, host: nuc, criticality: stop, timeout: 0.12 s}
  - {name: manual_control, type: manual_control, host: nuc, criticality: notify, timeout: 1 s}
  - {name: local_planner, type: local_planner, host: nuc, criticality: stop, timeout: 0.12 s}
)";

/// A robot in a hall that is told to drive at 1 m/s, its base at 0.5 m/s; each voice until it is
/// silent.
class Component : public testing::Test {
 protected:
  explicit Component(const std::string& more = {})
      : host(runtime::component_factory<MovementControlComponent>("movement_control"),
             kRobot + more + kManifest) {}
  void run(int ms) {
    for (int at = 0; at < ms; at += 20) {
      speak();
      host.run_for(milliseconds(20));
    }
  }
  double commanded() { return host.last(topics::kDriveCommand)->v(); }
  usher_msgs::msg::MovementStatus status() { return host.last(topics::kMovementStatus).value(); }

  runtime::TestHost host;
  std::set<std::string> silent;
  bool touched = false;  ///< its back right whisker
  /// Where somebody is, in base_footprint; nothing: nobody tells of people.
  std::optional<geometry::Point2> somebody;
  std::optional<bool> clear;  ///< what the people detector says; nothing: there is none
  double wanted_v = 1.0, wanted_w = 0.0;
  std::optional<geometry::Twist2> wanted_by_hand;
  std::string hand = "manual_control";  ///< who writes that
  double measured_v = 0.5;
  double pitch = 0.0;
  double wall = 100.0;  ///< [m] ahead of the laser
  milliseconds scan_late{0};
  std::optional<double>
      glass;  ///< [m] ahead of the axle in the local costs; nothing: there are none
  geometry::Pose2 odom_T_base{3.0, -2.0, 2.0};
  const char* costs_frame = "odom";
  std::uint8_t localization = usher_msgs::msg::LocalizationStatus_Constants::STATE_GOOD;
  bool floor = false;  ///< every beam ends on it

  /// Another manual_control wants to drive for so long.
  void second_of_the_name(int ms) {
    for (int at = 0; at < ms; at += 20) {
      geometry_msgs::msg::TwistStamped wanted;
      wanted.header(wire::header(host.now(), "base_footprint"));
      wanted.twist().linear().x(0.4);
      host.world().publish(topics::kCmdVelManual, wanted, "manual_control", "elsewhere");
      run(20);
    }
  }

 private:
  void speak() {
    const auto speaks = [this](const char* topic) { return !silent.contains(topic); };
    const auto header = wire::header(host.now(), "base_link");
    if (speaks("movement/enable")) {
      usher_msgs::msg::MovementEnable enable;
      enable.header(header);
      enable.movement(true), enable.navigation(true), enable.manual(true);
      enable.speed_factor(1.0F);
      enable.epoch(7);
      host.publish(topics::kMovementEnable, enable, "supervisor");
    }
    if (speaks("whiskers")) {
      usher_msgs::msg::Whiskers whiskers;
      whiskers.header(header);
      whiskers.back_right(touched);
      host.publish(topics::kWhiskers, whiskers);
    }
    if (speaks("base/status")) {
      usher_msgs::msg::BaseStatus base;
      base.header(header);
      base.state(usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING);
      base.v(measured_v);
      base.pitch(pitch);
      base.battery_percent(80.0F);
      host.publish(topics::kBaseStatus, base);
    }
    if (speaks("localization/status")) {
      usher_msgs::msg::LocalizationStatus status;
      status.header(header);
      status.state(localization);
      host.publish(topics::kLocalizationStatus, status);
    }
    if (speaks("scan/filtered")) {
      sensor_msgs::msg::LaserScan scan;
      scan.header(wire::header(host.now() - scan_late, "laser"));
      scan.angle_min(-1.0F), scan.angle_max(1.0F), scan.angle_increment(0.01F);
      scan.range_min(0.05F), scan.range_max(20.0F);
      for (int i = 0; i <= 200; ++i) {
        const double range = wall / std::cos(-1.0 + 0.01 * i);
        scan.ranges().push_back(floor          ? std::numeric_limits<float>::quiet_NaN()
                                : range > 20.0 ? std::numeric_limits<float>::infinity()
                                               : static_cast<float>(range));
      }
      host.publish(topics::kScanFiltered, scan);
    }
    if (speaks("odom")) {
      nav_msgs::msg::Odometry odom;
      odom.header(wire::header(host.now(), "odom"));
      odom.pose().pose(wire::to_message(odom_T_base));
      host.publish(topics::kOdom, odom);
    }
    if (glass && speaks("local_costmap/costs")) speak_costs();
    if (speaks("cmd_vel/navigation")) {
      geometry_msgs::msg::TwistStamped wanted;
      wanted.header(header);
      wanted.twist().linear().x(wanted_v);
      wanted.twist().angular().z(wanted_w);
      host.publish(topics::kCmdVelNavigation, wanted, "local_planner");
    }
    if (wanted_by_hand) {
      geometry_msgs::msg::TwistStamped wanted;
      wanted.header(header);
      wanted.twist().linear().x(wanted_by_hand->v);
      wanted.twist().angular().z(wanted_by_hand->w);
      host.publish(topics::kCmdVelManual, wanted, hand);
    }
    if (somebody && speaks("people")) {
      usher_msgs::msg::People people;
      people.header(wire::header(host.now(), "odom"));
      const geometry::Point2 place = odom_T_base * *somebody;
      auto& person = people.people().emplace_back();
      person.x(place.x()), person.y(place.y());
      host.publish(topics::kPeople, people, "people_detector");
    }
    if (clear && speaks("people/ahead")) {
      usher_msgs::msg::PersonAhead person;
      person.header(header);
      person.clear(*clear);
      host.publish(topics::kPersonAhead, person, "people_detector");
    }
  }
  /// A window of 6 m around the robot with a pane across its way.
  void speak_costs() {
    grid::Grid<std::uint8_t> costs({120, 120, 0.05, odom_T_base.x - 3.0, odom_T_base.y - 3.0});
    for (int i = -50; i <= 50; ++i) {
      const auto at = costs.geometry().cell_at(odom_T_base * geometry::Point2(*glass, 0.02 * i));
      costs.at(at) = 254;
    }
    host.publish(topics::kLocalCosts, wire::to_message(host.now(), costs_frame, costs));
  }
};

TEST_F(Component, HearsNobodyWhoMayNotWriteThoughWhoMayIsSilent) {
  silent = {"cmd_vel/navigation"};
  run(600);
  ASSERT_EQ(commanded(), 0.0);
  host.clear();
  wanted_by_hand = {0.4, 0.3};
  hand = "intruder";
  run(600);
  for (const auto& command : host.written(topics::kDriveCommand)) {
    EXPECT_EQ(command.v(), 0.0);
    EXPECT_EQ(command.w(), 0.0);
  }
  EXPECT_EQ(host.counter("cmd_vel/manual: foreign writer"), 30U);
  wanted_by_hand.reset();
  run(300);
  wanted_by_hand = {0.4, 0.0};
  hand = "manual_control";
  run(600);
  EXPECT_GT(commanded(), 0.1);
}

TEST_F(Component, HearsASecondOneOfANameOnlyWhenTheFirstHasLeft) {
  silent = {"cmd_vel/navigation"};
  wanted_by_hand = {0.0, 0.0};
  run(400);
  wanted_by_hand.reset();
  run(400);
  second_of_the_name(2000);
  EXPECT_EQ(commanded(), 0.0);
  host.world().leave("manual_control");
  second_of_the_name(600);
  EXPECT_GT(commanded(), 0.1);
}

TEST_F(Component, NeverHearsWhoClaimedANameBesideItsHolder) {
  silent = {"cmd_vel/navigation"};
  wanted_by_hand = {0.0, 0.0};
  run(400);
  second_of_the_name(400);
  wanted_by_hand.reset();
  host.world().leave("manual_control");
  second_of_the_name(2000);
  EXPECT_EQ(commanded(), 0.0);
}

TEST_F(Component, DrivesWhatIsWantedUnderTheEpochOfTheEnable) {
  run(3000);
  EXPECT_NEAR(commanded(), 1.0, 1e-6);
  EXPECT_EQ(host.last(topics::kDriveCommand)->epoch(), 7U);
  EXPECT_TRUE(status().ok()) << status().limit_reason();
}

class SlowComponent : public Component {
 protected:
  SlowComponent() : Component("robot.limits.linear: 0.3 m/s\nrobot.limits.angular: 0.2 rad/s\n") {}
};

TEST_F(SlowComponent, WantsNoMoreThanItsBaseObeys) {
  const auto most = [this](double v, double w) {
    host.clear();
    wanted_v = v, wanted_w = w;
    run(3000);
    geometry::Twist2 found;
    for (const auto& command : host.written(topics::kDriveCommand)) {
      found.v = std::max(found.v, command.v());
      found.w = std::max(found.w, command.w());
    }
    return found;
  };
  const auto straight = most(1.12, 0.0);  // 1.12 * (0.3 / 1.12) is more than 0.3
  EXPECT_EQ(straight.v, 0.3);
  const auto arc = most(1.0, 1.0);
  EXPECT_LE(arc.v, 0.3);
  EXPECT_EQ(arc.w, 0.2) << "the narrower limit";
}

class WatchfulComponent : public Component {
 protected:
  WatchfulComponent()
      : Component(
            "robot.response.linear_threshold: 0.3 m/s\n"
            "robot.response.linear_patience: 0.7 s\n"
            "robot.response.angular_threshold: 0.6 rad/s\n"
            "robot.response.angular_patience: 0.8 s\n") {}
};

TEST_F(WatchfulComponent, TellsTheThresholdsOfTheRobot) {
  run(200);
  EXPECT_FLOAT_EQ(status().velocity_threshold_linear(), 0.3F);
  EXPECT_FLOAT_EQ(status().velocity_threshold_linear_time(), 0.7F);
  EXPECT_FLOAT_EQ(status().velocity_threshold_angular(), 0.6F);
  EXPECT_FLOAT_EQ(status().velocity_threshold_angular_time(), 0.8F);
}

TEST_F(Component, HearsNobodyBesideTheOneWhoWishesAlready) {
  run(3000);
  const auto meddle = [this] {
    geometry_msgs::msg::TwistStamped wanted;
    wanted.header(wire::header(host.now(), "base_link"));
    wanted.twist().linear().x(0.2), wanted.twist().angular().z(0.5);
    host.publish(topics::kCmdVelNavigation, wanted, "rogue");
    usher_msgs::msg::MovementEnable enable;
    enable.header(wanted.header());
    enable.movement(true), enable.navigation(true);
    enable.speed_factor(0.1F);
    host.publish(topics::kMovementEnable, enable, "rogue");
  };
  for (int i = 0; i < 50; ++i) {
    run(20);
    meddle();
    host.run_for(milliseconds(1));
    ASSERT_EQ(host.last(topics::kDriveCommand)->w(), 0.0);
    ASSERT_NEAR(commanded(), 1.0, 1e-6);
    ASSERT_EQ(host.last(topics::kDriveCommand)->epoch(), 7U);
  }
}

TEST_F(Component, WhatFallsSilentStopsIt) {
  const struct {
    const char* topic;
    int age;
  } rows[] = {{"movement/enable", 120},
              {"whiskers", 300},
              {"base/status", 150},
              {"localization/status", 1000},
              {"cmd_vel/navigation", 250}};
  for (const auto& row : rows) {
    silent.clear();
    run(3000);
    ASSERT_GT(commanded(), 0.9) << row.topic;
    silent.insert(row.topic);
    run(row.age - 60);
    EXPECT_GT(commanded(), 0.5) << row.topic << ": not yet";
    run(100);
    EXPECT_EQ(commanded(), 0.0) << row.topic;
  }
}

TEST_F(Component, AStateOfTheLocalizationThatIsNoneCountsAsLost) {
  run(3000);
  ASSERT_GT(commanded(), 0.9);
  localization = usher_msgs::msg::LocalizationStatus_Constants::STATE_GOOD + 1;
  run(1000);
  EXPECT_EQ(commanded(), 0.0);
}

TEST_F(Component, WithoutAScanTheNavigationCreeps) {
  run(3000);
  silent.insert("scan/filtered");
  run(2000);
  EXPECT_NEAR(commanded(), 0.1, 1e-6);
  EXPECT_EQ(status().obstacle_distance(), 0.0F) << "nobody knows";
}

TEST_F(Component, LateScansTellNothing) {
  run(3000);
  scan_late = milliseconds(500);
  run(2000);
  EXPECT_NEAR(commanded(), 0.1, 1e-6);
  scan_late = milliseconds(0);
  run(3000);
  EXPECT_GT(commanded(), 0.5);
}

TEST_F(Component, APersonAheadLimitsTheSpeedAndSoDoesASilentDetector) {
  wanted_v = 1.4;
  run(4000);
  EXPECT_NEAR(commanded(), 1.4, 1e-6) << "nobody was ever heard of";
  clear = true;
  run(1000);
  EXPECT_NEAR(commanded(), 1.4, 1e-6);
  clear = false;
  run(2000);
  EXPECT_NEAR(commanded(), 1.0, 1e-6);
  EXPECT_TRUE(status().person_ahead());
  EXPECT_EQ(status().limit_reason(), "a person is ahead");
  wanted_w = 1.4;
  run(2000);
  EXPECT_NEAR(host.last(topics::kDriveCommand)->w(), 0.5, 1e-6);
  EXPECT_NEAR(commanded(), 0.5, 1e-6) << "the same arc";
  wanted_w = 0.0, clear = true;
  run(2000);
  EXPECT_NEAR(commanded(), 1.4, 1e-6);
  EXPECT_FALSE(status().person_ahead());
  silent.insert("people/ahead");
  run(440);
  EXPECT_NEAR(commanded(), 1.4, 1e-6) << "not yet";
  run(2000);
  EXPECT_NEAR(commanded(), 1.0, 1e-6);
  EXPECT_TRUE(status().person_ahead());
}

TEST_F(Component, AnOperatorDrivesNoFasterThanItStops) {
  wanted_by_hand = {0.8, 0.0};
  run(2000);
  EXPECT_NEAR(commanded(), 0.8, 1e-6);
  measured_v = 0.0;
  wall = 0.54;  // half a metre before the outline's margin
  run(200);
  EXPECT_NEAR(commanded(), 0.5 / 1.48, 0.02);
  EXPECT_EQ(status().limit_reason(), "something is in the way");
  EXPECT_NEAR(status().velocity_current_linear_max(), commanded(), 1e-6);
  wall = 0.03;
  run(200);
  EXPECT_EQ(commanded(), 0.0);
  wanted_by_hand = {-0.3, 0.0};
  run(2000);
  EXPECT_NEAR(commanded(), -0.3, 1e-6) << "and gets away from it";
  wanted_by_hand.reset();
  run(2000);
  EXPECT_EQ(commanded(), 0.0) << "nor does the navigation get in";
  EXPECT_EQ(status().limit_reason(), "something is in the way");
  EXPECT_EQ(host.counter("guard: held back the navigation"), 1U);
}

TEST_F(Component, NobodyDrivesIntoWhatOnlyTheLocalCostsKnow) {
  run(2000);
  measured_v = 0.0;
  glass = 0.3 + 0.08 + 0.5;
  run(200);
  EXPECT_NEAR(commanded(), 0.5 / 1.48, 0.03) << "the navigation";
  EXPECT_EQ(status().limit_reason(), "something is in the way");
  EXPECT_NEAR(status().obstacle_distance(), 0.58, 0.05);
  wanted_by_hand = {0.8, 0.0};
  run(1000);
  EXPECT_NEAR(commanded(), 0.5 / 1.48, 0.03) << "the operator";
  glass = -0.7;
  run(1000);
  EXPECT_NEAR(commanded(), 0.8, 1e-6) << "behind it bars nothing";
}

TEST_F(Component, CostsThatTellNothingOfWhatIsAheadAreNotLookedAt) {
  glass = 0.4;
  run(1000);
  ASSERT_LT(commanded(), 0.05);
  for (const char* topic : {"local_costmap/costs", "odom"}) {
    silent = {topic};
    run(80);
    EXPECT_LT(commanded(), 0.05) << topic << ": not yet";
    run(2000);
    EXPECT_NEAR(commanded(), 1.0, 1e-6) << topic;
    silent.clear();
    run(200);
    EXPECT_LT(commanded(), 0.05) << topic << ": back";
  }
  localization = usher_msgs::msg::LocalizationStatus_Constants::STATE_LOST;
  wanted_by_hand = {0.3, 0.0};
  run(2000);
  EXPECT_NEAR(commanded(), 0.3, 1e-6) << "the map's walls are elsewhere";
  localization = usher_msgs::msg::LocalizationStatus_Constants::STATE_GOOD;
  run(200);
  EXPECT_LT(commanded(), 0.05);
  EXPECT_EQ(host.counter("local costs: rejected"), 0U);
  costs_frame = "map";
  run(2000);
  EXPECT_NEAR(commanded(), 0.3, 1e-6) << "in another frame";
  EXPECT_GT(host.counter("local costs: rejected"), 0U);
}

TEST_F(Component, WithoutPeopleTheCostsExplainNoTouch) {
  measured_v = wanted_v = 0.0;
  wanted_w = 0.5;
  touched = true;
  glass = -0.45;
  somebody = geometry::Point2(2.0, 0.0);
  const auto turns = [&] {
    run(600);  // before it is taken to press against something
    const double turn = host.last(topics::kDriveCommand)->w();
    touched = false;
    run(100);
    touched = true;
    return turn > 0.0;
  };
  EXPECT_TRUE(turns());
  somebody = geometry::Point2(-0.6, -0.5);
  EXPECT_FALSE(turns()) << "the costs may know him";
  somebody = geometry::Point2(2.0, 0.0);
  silent = {"people"};
  EXPECT_FALSE(turns()) << "it may be somebody";
  silent = {"odom"};
  EXPECT_FALSE(turns()) << "where is he?";
  silent.clear();
  run(100);
  EXPECT_TRUE(turns());
}

TEST_F(Component, WithoutAScanAnOperatorCreeps) {
  wanted_by_hand = {0.8, 0.0};
  run(2000);
  silent.insert("scan/filtered");
  run(400);
  EXPECT_NEAR(commanded(), 0.1, 1e-6);
  EXPECT_EQ(status().limit_reason(), "no scan tells what is ahead");
}

TEST_F(Component, AnOperatorCreepsOnceTheScansHaveToldNothingForLongerThanAStartLeans) {
  wanted_by_hand = {0.8, 0.0};
  pitch = 0.03;
  run(2000);
  floor = true;
  run(2300);
  EXPECT_NEAR(commanded(), 0.8, 1e-6);
  run(400);
  EXPECT_NEAR(commanded(), 0.1, 1e-6);
  for (const double no_excuse : {0.01, -0.03}) {
    floor = false;
    run(2000);
    EXPECT_NEAR(commanded(), 0.8, 1e-6);
    pitch = no_excuse;
    run(400);
    floor = true;
    run(200);
    EXPECT_NEAR(commanded(), 0.8, 1e-6);
    run(200);
    EXPECT_NEAR(commanded(), 0.1, 1e-6) << "it does not lean forward by " << no_excuse;
  }
  floor = false;
  run(2000);
  pitch = 0.03;
  measured_v = 0.8;
  run(400);
  floor = true;
  run(400);
  EXPECT_NEAR(commanded(), 0.1, 1e-6) << "it leans, as a load makes it, and speeds up no more";
}

TEST_F(Component, TheStatusTellsWhatIsAhead) {
  run(3000);
  EXPECT_FALSE(status().person_ahead());
  EXPECT_EQ(status().obstacle_distance(), std::numeric_limits<float>::infinity());
  EXPECT_EQ(status().time_to_collision(), std::numeric_limits<float>::infinity());
  wall = 3.02;
  run(300);
  EXPECT_NEAR(status().obstacle_distance(), 3.02 + 0.28 - 0.3, 0.01) << "from the outline's front";
  EXPECT_NEAR(status().time_to_collision(), 6.0, 0.05) << "at the base's 0.5 m/s";
  EXPECT_NEAR(status().stopping_distance(), 0.74, 0.01);
}

}  // namespace
}  // namespace usher::movement_control
