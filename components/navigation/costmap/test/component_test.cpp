#include "navigation/costmap/shell/component.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "navigation/costmap/core/costs.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/low_scan.hpp"

namespace usher::costmap {
namespace {

using std::chrono::milliseconds;
constexpr int kPassing = 252;  // of what bars the way on the map's free ground
constexpr const char* kFootprint = "robot.footprint: [0.3, 0.3, -0.3, 0.3, -0.3, -0.3, 0.3, -0.3]";

/// A robot in the middle of a room of 8 m with a wall 2 m ahead that only the laser knows; each of
/// its senses can be left out.
class Component : public testing::Test {
 protected:
  Component() {
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "laser", geometry::Pose3{}));
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "ultrasonic", geometry::Pose3{}));
    host.publish(topics::kTfStatic, fixed);
  }
  void give_map() {
    map_stamp = host.now();
    host.publish(topics::kMap, wire::to_message(map_stamp, frames::kMap, map));
    host.run_for(milliseconds(5));
  }
  sensor_msgs::msg::LaserScan scan(const char* frame = "laser", float range = 2.0F) const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now(), frame));
    message.angle_min(-0.2F);
    message.angle_increment(0.005F);
    message.angle_max(0.2F);
    message.range_min(0.1F);
    message.range_max(20.0F);
    message.ranges().assign(81, range);
    return message;
  }
  /// The laser sees something ahead, 3.5 m away beside it.
  void look(float middle, int ms) {
    for (int at = 0; at < ms; at += 20) {
      auto message = scan("laser", 3.5F);
      std::fill_n(message.ranges().begin() + 20, 40, middle);
      host.publish(topics::kScanFiltered, message);
      run(20, false);
    }
  }
  void run(int ms, bool scans = true, bool localized = true) {
    for (int at = 0; at < ms; at += 20) {
      tf2_msgs::msg::TFMessage moving;
      moving.transforms().push_back(wire::transform(
          host.now(), frames::kOdom, frames::kBaseFootprint, geometry::to_space(base)));
      if (localized)
        moving.transforms().push_back(
            wire::transform(host.now(), frames::kMap, frames::kOdom, geometry::to_space(odom)));
      host.publish(topics::kTf, moving);
      if (scans) {
        host.publish(topics::kScanFiltered, scan("laser", laser_range));
        last_scan = host.now();
      }
      host.run_for(milliseconds(20));
    }
  }
  /// The front whiskers say so, then time passes.
  void feel(bool left, bool right = false, int ms = 1500) {
    usher_msgs::msg::Whiskers whiskers;
    whiskers.header(wire::header(last_scan, frames::kBaseLink));
    whiskers.front_left(left);
    whiskers.front_right(right);
    host.publish(topics::kWhiskers, whiskers);
    run(ms);
  }
  /// Somebody is there, or was as many seconds ago.
  void tell_of(double x, double y, float unseen = 0.0F) {
    usher_msgs::msg::People people;
    people.header(wire::header(host.now(), frames::kOdom));
    auto& somebody = people.people().emplace_back();
    somebody.x(x);
    somebody.y(y);
    somebody.unseen(unseen);
    host.publish(topics::kPeople, people);
  }
  std::string reason() const { return host.heartbeat().reason(); }
  /// The highest cost within a cell's width: points lie on the borders of cells.
  int local_cost(double x, double y) const {
    const auto costs = wire::from_message(host.last(topics::kLocalCosts).value());
    int highest = 0;
    for (const double dx : {-0.04, 0.0, 0.04}) {
      for (const double dy : {-0.04, 0.0, 0.04})
        highest = std::max(highest, int{costs->at(costs->geometry().cell_at(x + dx, y + dy))});
    }
    return highest;
  }

  int global_cost(double x, double y) const {
    const auto costs = wire::from_message(host.last(topics::kGlobalCosts).value());
    return costs->at(costs->geometry().cell_at(x, y));
  }

  grid::OccupancyGrid map{{160, 160, 0.05, -4.0, -4.0}, grid::kFree};
  runtime::TestHost host{runtime::component_factory<CostmapComponent>("costmap"), kFootprint};
  runtime::Time map_stamp{}, last_scan{};
  geometry::Pose2 base;  // in odom
  geometry::Pose2 odom;  // in map
  float laser_range = 2.0F;
  static constexpr float kNothing = std::numeric_limits<float>::infinity();
};

TEST_F(Component, MarksWhatTheLaserSees) {
  give_map();
  run(1500);
  EXPECT_EQ(reason(), "");
  EXPECT_EQ(local_cost(2.0, 0.0), kLethalCost);
  EXPECT_EQ(local_cost(1.0, 0.0), kFreeCost);
}

TEST_F(Component, SaysNothingNewWithoutScansAndReturnsWithThem) {
  give_map();
  run(1500);
  run(600, false);
  EXPECT_EQ(reason(), "no scan");
  host.clear();
  run(600, false);
  EXPECT_TRUE(host.written(topics::kLocalCosts).empty()) << "old costs are not made new";
  run(1000);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, StampsTheGlobalCostsWithTheNewestDataInThem) {
  give_map();
  run(100, false);
  EXPECT_EQ(wire::from_message(host.last(topics::kGlobalCosts)->header().stamp()), map_stamp);
  run(2500);
  host.run_for(milliseconds(1500));
  const auto stamp = wire::from_message(host.last(topics::kGlobalCosts)->header().stamp());
  EXPECT_LE(stamp, last_scan);
  EXPECT_GE(stamp, last_scan - milliseconds(100));
  EXPECT_GT(host.now() - stamp, milliseconds(1400)) << "and not with the time of writing";
}

TEST_F(Component, SaysThatThereIsNoMap) {
  run(1000);
  EXPECT_EQ(reason(), "no map");
  EXPECT_FALSE(host.last(topics::kGlobalCosts));
  EXPECT_EQ(local_cost(2.0, 0.0), kLethalCost) << "what the laser sees counts all the same";
}

TEST_F(Component, SaysWhyAMapIsRefusedUntilThereIsABetterOne) {
  auto message = wire::to_message(host.now(), frames::kMap, map);
  message.info().resolution(0.0F);
  host.publish(topics::kMap, message);
  run(1500);
  EXPECT_TRUE(reason().starts_with("map refused: ")) << reason();
  EXPECT_EQ(host.counter("map: rejected"), 1U);
  give_map();
  run(500);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, SaysThatTheRobotIsNotLocalized) {
  give_map();
  run(1000, true, false);
  EXPECT_EQ(reason(), "robot not localized");
}

TEST_F(Component, PutsTheMapIntoTheWindowOnlyOnceItsPlaceIsKnown) {
  map.at(map.geometry().cell_at(-1.0, 0.02)) = grid::kOccupied;  // behind: no sensor sees it
  give_map();
  run(500, true, false);
  EXPECT_EQ(local_cost(-1.0, 0.02), kFreeCost);
  run(200);
  EXPECT_EQ(local_cost(-1.0, 0.02), kLethalCost);
}

TEST_F(Component, GoesOnWithoutTheUltrasonicSensorsAndTheWhiskers) {
  give_map();
  run(1500);
  EXPECT_EQ(reason(), "") << "neither was ever heard";
  usher_msgs::msg::Whiskers whiskers;
  for (int i = 0; i < 10; ++i) {
    host.publish(topics::kUltrasonicFiltered, scan("ultrasonic", 1.2F));
    run(20);
    whiskers.header(wire::header(last_scan, frames::kBaseLink));
    host.publish(topics::kWhiskers, whiskers);
  }
  EXPECT_EQ(local_cost(1.2, 0.0), kLethalCost);
  run(1500);  // their ages are 0.5 and 0.3 s
  EXPECT_EQ(reason(), "") << "both fell silent";
  EXPECT_EQ(local_cost(1.2, 0.0), kLethalCost) << "the glass that was heard";
  EXPECT_EQ(local_cost(2.0, 0.0), kLethalCost) << "the laser goes on";
}

TEST_F(Component, KeepsTheGlassThatLeftAConeByItsEdge) {
  give_map();
  sensor_msgs::msg::LaserScan sonar = scan("ultrasonic");
  sonar.angle_min(0.0F);
  sonar.angle_increment(0.52F);
  sonar.angle_max(0.0F);
  const auto hear = [&](float range) {
    for (int i = 0; i < 10; ++i) {
      sonar.header(wire::header(host.now(), "ultrasonic"));
      sonar.ranges().assign(1, range);
      host.publish(topics::kUltrasonicFiltered, sonar);
      run(40);
    }
  };
  const geometry::Point2 edge(1.5 * std::cos(0.13), 1.5 * std::sin(0.13));
  hear(1.5F);
  EXPECT_EQ(local_cost(1.5, 0.0), kLethalCost);
  EXPECT_EQ(local_cost(edge.x(), edge.y()), kLethalCost);
  hear(std::numeric_limits<float>::infinity());
  EXPECT_LT(local_cost(1.5, 0.0), kLethalCost) << "nothing is straight ahead";
  EXPECT_EQ(local_cost(edge.x(), edge.y()), kLethalCost) << "a gap between two cones begins here";
  EXPECT_EQ(local_cost(edge.x(), -edge.y()), kLethalCost);
  run(5500);
  EXPECT_LT(local_cost(edge.x(), edge.y()), kLethalCost) << "not heard again for long";
}

TEST_F(Component, KeepsWhatADepthCameraSawThatFallsSilent) {
  for (const auto* topic : {&topics::kKinectScan, &topics::kKinectScanLow, &topics::kRearScan}) {
    SCOPED_TRACE(topic->name);
    base.x += 6.0;  // what the one before saw is out of the window
    give_map();
    run(200);
    for (int i = 0; i < 10; ++i) host.publish(*topic, scan("laser", 1.0F)), run(40);
    EXPECT_EQ(local_cost(base.x + 1.0, 0.0), kLethalCost);
    run(1500);  // its age is 0.5 s
    EXPECT_EQ(local_cost(base.x + 1.0, 0.0), kLethalCost) << "no laser clears what it cannot see";
    EXPECT_EQ(local_cost(base.x + 2.0, 0.0), kLethalCost) << "the laser goes on";
    EXPECT_EQ(reason(), "");
  }
}

TEST_F(Component, ForgetsALowThingThatIsGoneBeforeAWall) {
  give_map();
  run(200);
  const auto see = [&](float range) {
    for (int i = 0; i < 10; ++i)
      host.publish(topics::kKinectScanLow, scan("laser", range)), run(40);
  };
  see(2.2F);
  EXPECT_EQ(local_cost(2.22, 0.17), kLethalCost);
  see(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(local_cost(2.22, 0.17), kLethalCost) << "nothing is known";
  see(-2.9F);
  EXPECT_LT(local_cost(2.22, 0.17), kLethalCost) << "a wall is at 2.9 m, and nothing low before it";
  EXPECT_LT(local_cost(2.9, 0.17), kLethalCost) << "the wall is for other layers";
}

TEST_F(Component, RemembersTheFootOfAThingAsLongAsTheLaserSeesIt) {
  for (const bool mapped : {false, true}) {
    if (mapped) {
      for (int y = 0; y < map.height(); ++y) map.at({120, y}) = grid::kOccupied;  // x = 2 m
    }
    give_map();
    look(2.03F, 300);
    for (int i = 0; i < 5; ++i) {
      host.publish(topics::kKinectScanLow, scan("laser", 1.7F));
      look(2.03F, 40);
    }
    look(2.03F, 2000);
    EXPECT_EQ(local_cost(1.72, 0.0), kLethalCost) << "the camera looks over it";
    look(3.5F, 1500);  // who stood there has gone, or a door is open
    EXPECT_EQ(local_cost(1.72, 0.0) == kLethalCost, mapped) << "what stands before a wall stays";
    EXPECT_EQ(global_cost(1.72, 0.0) >= kPassing, mapped);
  }
}

TEST_F(Component, RemembersADropBesideSomebodyWhoHasLeft) {
  for (const float intensity : {1.0F, wire::kDrop}) {
    SCOPED_TRACE(intensity);
    give_map();
    look(2.03F, 300);  // he stands at the top of the stairs
    for (int i = 0; i < 5; ++i) {
      auto low = scan("laser", 1.7F);
      low.intensities().assign(low.ranges().size(), intensity);
      host.publish(topics::kKinectScanLow, low);
      look(2.03F, 40);
    }
    EXPECT_EQ(local_cost(1.72, 0.0), kLethalCost);
    look(3.5F, 1500);
    const bool drop = intensity == wire::kDrop;
    EXPECT_EQ(local_cost(1.72, 0.0) == kLethalCost, drop) << "a thing may have been his foot";
    EXPECT_EQ(global_cost(1.72, 0.0) >= kPassing, drop);
  }
}

TEST_F(Component, RemembersNoFloorThatSomebodyHides) {
  give_map();
  laser_range = 3.5F;
  run(200);
  const auto see = [&](double aside, float unseen, float intensity = wire::kDrop) {
    for (int i = 0; i < 5; ++i) {
      tell_of(0.6, aside, unseen);
      run(20);
      auto low = scan("laser", 2.2F);
      low.intensities().assign(low.ranges().size(), intensity);
      host.publish(topics::kKinectScanLow, low);
      run(20);
    }
  };
  see(0.2, 0.0F);
  EXPECT_LT(local_cost(2.22, 0.0), kLethalCost);
  see(0.2, 1.5F);
  EXPECT_LT(local_cost(2.22, 0.0), kLethalCost) << "too near to be detected";
  see(0.2, 0.0F, wire::kDropBehindFloor);
  EXPECT_EQ(local_cost(2.22, 0.0), kLethalCost) << "the floor before it is seen: nobody hides it";
}

TEST_F(Component, RemembersFloorThatIsMissingBesideTheLineToSomebody) {
  give_map();
  laser_range = 3.5F;
  run(200);
  for (int i = 0; i < 5; ++i) {
    tell_of(0.6, 1.0);
    host.publish(topics::kKinectScanLow, scan("laser", 2.2F));
    run(20);
  }
  EXPECT_EQ(local_cost(2.22, 0.0), kLethalCost) << "he is not in the line of sight";
}

TEST_F(Component, KeepsWhatIsTooNearForTheKinectToSee) {
  laser_range = 3.5F;
  give_map();
  run(200);
  const auto see = [&](float range) {
    auto message = scan("laser", range);
    message.intensities().assign(message.ranges().size(), 0.9F);
    host.publish(topics::kKinectScan, message);
    run(40);
  };
  for (; base.x < 0.65; base.x += 0.02) {  // a belt at 1.4 m, over the laser
    const auto gap = static_cast<float>(1.4 - base.x);
    see(gap > 0.85F ? gap : kNothing);
  }
  for (int i = 0; i < 2500; ++i) see(kNothing);
  EXPECT_EQ(local_cost(1.4, 0.0), kLethalCost) << "0.75 m ahead, 100 s later";
  usher_msgs::msg::CostmapRequest recovery;
  recovery.id(1);
  host.publish(topics::kCostmapRequest, recovery);
  see(kNothing);
  EXPECT_EQ(local_cost(1.4, 0.0), kLethalCost) << "a recovery would not see it again";
  base.x = 0.3;
  for (int i = 0; i < 5; ++i) see(kNothing);
  EXPECT_LT(local_cost(1.4, 0.0), kLethalCost) << "gone, as is seen from afar";
}

TEST_F(Component, RemembersNothingNearThatTheKinectIsNotSureOf) {
  laser_range = 3.5F;
  give_map();
  run(200);
  for (const float range : {0.8F, kNothing}) {
    for (int i = 0; i < 5; ++i) {
      auto message = scan("laser", range);
      message.intensities().assign(message.ranges().size(), 0.5F);
      host.publish(topics::kKinectScan, message);
      run(40);
    }
    EXPECT_EQ(local_cost(0.82, 0.0) == kLethalCost, range == 0.8F);
  }
}

TEST_F(Component, RemembersNobodyWhoIsTooNearForTheKinect) {
  laser_range = 3.5F;
  give_map();
  run(200);
  const auto see = [&](float range, bool told = true) {
    for (int i = 0; i < 5; ++i) {
      if (told) tell_of(0.85, 0.0);
      host.publish(topics::kKinectScan, scan("laser", range));
      run(40);
    }
  };
  see(0.7F);
  EXPECT_EQ(local_cost(0.72, 0.0), kLethalCost);
  run(2500);
  see(kNothing, false);
  EXPECT_LT(local_cost(0.72, 0.0), kLethalCost) << "he has left, and nobody saw him go";
}

TEST_F(Component, ForgetsADoorLeafThatOpensBeforeIt) {
  give_map();
  for (int i = 0; i < 5; ++i) {
    look(0.72F, 40);
    host.publish(topics::kKinectScan, scan("laser", 0.7F));
  }
  look(0.72F, 100);
  EXPECT_EQ(local_cost(0.72, 0.0), kLethalCost);
  for (int i = 0; i < 5; ++i) {
    look(3.5F, 40);
    host.publish(topics::kKinectScan, scan("laser", kNothing));
  }
  look(3.5F, 100);
  EXPECT_LT(local_cost(0.72, 0.0), kLethalCost) << "the laser saw it, too, and sees nothing now";
}

TEST_F(Component, RemembersNothingNearWhileNobodyTellsOfPeople) {
  laser_range = 3.5F;
  give_map();
  run(200);
  tell_of(0.0, 3.0);
  run(1000);
  for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", 0.7F)), run(40);
  EXPECT_EQ(local_cost(0.72, 0.0), kLethalCost);
  for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", kNothing)), run(40);
  EXPECT_LT(local_cost(0.72, 0.0), kLethalCost) << "it may have been somebody";
}

TEST_F(Component, KnowsTheBeltBehindWhichSomebodyComesToStand) {
  for (const int before : {1000, 3000}) {  // [ms] that it was seen too near to be seen again
    SCOPED_TRACE(before);
    base.x += 6.0;
    laser_range = 3.5F;
    give_map();
    run(200);
    for (int i = 0; i < 5; ++i) {
      tell_of(base.x - 2.0, 0.0);  // somebody else
      host.publish(topics::kKinectScan, scan("laser", 0.7F));
      run(40);
    }
    run(before);
    for (int i = 0; i < 5; ++i) {
      tell_of(base.x + 0.95, 0.0);
      host.publish(topics::kKinectScan, scan("laser", 0.85F));
      run(40);
    }
    run(2500);
    for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", kNothing)), run(40);
    const bool belt = local_cost(base.x + 0.72, 0.0) == kLethalCost;
    EXPECT_EQ(belt, before == 3000) << "what was seen shortly before may have been himself";
  }
}

TEST_F(Component, PlansAroundWhatASlowCameraSeesBetweenTheScansOfAFastLaser) {
  give_map();
  run(200);
  for (int i = 0; i < 100; ++i) {
    if (i % 5 == 0)
      host.publish(topics::kRearScan, scan("laser", 1.0F));
    else
      host.publish(topics::kScanFiltered, scan());
    run(20, false);
  }
  EXPECT_EQ(global_cost(1.02, 0.02), 252) << "the highest that a planner crosses";
}

class LooksBack : public Component {
 protected:
  LooksBack() {
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(wire::transform(host.now(), frames::kBaseFootprint, "rear",
                                                 geometry::to_space({0.0, 0.0, geometry::kPi})));
    host.publish(topics::kTfStatic, fixed);
    give_map();
    run(200);
  }
  void see(float range, int times = 1) {
    for (int i = 0; i < times; ++i) host.publish(topics::kRearScan, scan("rear", range)), run(60);
  }
  /// Somebody is told of there, and the camera sees that far.
  void follow(double x, float range, int times) {
    for (int i = 0; i < times; ++i) {
      tell_of(x, 0.0);
      see(range);
    }
  }
};

TEST_F(LooksBack, AndKeepsTheLowBoxThatItBacksUpTo) {
  for (; base.x > -0.8; base.x -= 0.02) {  // the box is at -1.5 and leaves the image at 1.1 m
    const auto gap = static_cast<float>(base.x + 1.5);
    see(gap > 1.1F ? gap : kNothing);
  }
  EXPECT_EQ(local_cost(-1.5, 0.0), kLethalCost);
  base.x = 0.0;
  see(kNothing, 10);
  EXPECT_LT(local_cost(-1.5, 0.0), kLethalCost) << "gone, as is seen from afar";
}

TEST_F(LooksBack, AndForgetsWhereSomebodyStoodWhoWalksOn) {
  follow(-0.95, 0.82F, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost);
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  follow(-0.95, unknown, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost) << "too near to be measured, perhaps";
  follow(-1.2, 1.02F, 10);
  EXPECT_LT(local_cost(-0.82, 0.0), kLethalCost) << "he stepped back: it may turn there";
  EXPECT_EQ(local_cost(-1.02, 0.0), kLethalCost);
}

TEST_F(LooksBack, AndKeepsTheBoxFarFromWhoeverFollows) {
  see(0.82F, 10);
  follow(-1.6, kNothing, 10);
  EXPECT_EQ(local_cost(-0.82, 0.0), kLethalCost) << "0.8 m before him";
  follow(-1.1, kNothing, 10);
  EXPECT_LT(local_cost(-0.82, 0.0), kLethalCost) << "the price: a box at his feet";
}

TEST_F(Component, GivesPeopleRoomUntilNobodyTellsOfThem) {
  give_map();
  const auto tell = [&](double x, double vx, float unseen = 0.0F) {
    usher_msgs::msg::People people;
    people.header(wire::header(last_scan, frames::kOdom));
    people.people().resize(2);
    people.people()[0].x(x), people.people()[0].vx(vx), people.people()[0].unseen(unseen);
    people.people()[1].x(std::numeric_limits<double>::quiet_NaN());
    host.publish(topics::kPeople, people);
  };
  run(500);
  const auto keep_telling = [&](double x, double vx, float unseen = 0.0F) {
    for (int i = 0; i < 20; ++i) tell(x, vx, unseen), run(60);
  };
  keep_telling(1.0, 0.0);
  EXPECT_NEAR(local_cost(1.0, 0.0), 80, 4);
  EXPECT_NEAR(global_cost(1.0, 0.0), 80, 4) << "who stands is on the map too";
  EXPECT_GT(local_cost(1.0, 1.0), 5);
  EXPECT_EQ(local_cost(1.0, 1.3), kFreeCost);
  run(1500);
  EXPECT_EQ(local_cost(1.0, 0.0), kFreeCost) << "nobody tells of them";
  EXPECT_EQ(global_cost(1.0, 0.0), kFreeCost);
  EXPECT_EQ(reason(), "");
  keep_telling(1.0, 1.0);
  EXPECT_NEAR(local_cost(1.0, 0.0), 80, 4);
  EXPECT_EQ(global_cost(1.0, 0.0), kFreeCost) << "who walks is elsewhere by then";
  keep_telling(1.0, 0.0, 0.8F);
  EXPECT_EQ(local_cost(1.0, 0.0), kFreeCost) << "not seen lately";
  keep_telling(-1.0, 0.0);
  EXPECT_EQ(local_cost(-1.0, 0.0), kFreeCost) << "who is behind sees the robot";
}

TEST_F(Component, KeepsTheLastContactsOfWhiskersThatFallSilent) {
  give_map();
  run(500);
  usher_msgs::msg::Whiskers whiskers;
  whiskers.header(wire::header(host.now(), frames::kBaseLink));
  whiskers.front_left(true);
  run(20);
  whiskers.header(wire::header(last_scan, frames::kBaseLink));
  host.publish(topics::kWhiskers, whiskers);
  run(1000);
  EXPECT_EQ(local_cost(0.4, 0.3), kLethalCost);
}

TEST_F(Component, PlansRoundWhatAWhiskerFelt) {
  give_map();
  run(500);
  feel(true);
  base.x -= 1.0;  // it backs off
  run(100);
  feel(false);
  EXPECT_LT(local_cost(0.42, 0.32), kLethalCost);
  EXPECT_EQ(global_cost(0.42, 0.32), 252) << "to be crossed where there is no other way";
  run(60'000);
  feel(false);
  EXPECT_LT(global_cost(0.42, 0.32), 252);
}

TEST_F(Component, KeepsAContactWhileWhiskersAreHeldAtAnotherPlace) {
  give_map();
  run(500);
  feel(true, false, 1500);
  base.x -= 1.0;
  run(100);
  for (int i = 0; i < 200; ++i) feel(true, true, 20);
  base.x -= 1.0;
  run(100);
  feel(false, false, 1500);
  EXPECT_EQ(global_cost(0.42, 0.32), 252);
  EXPECT_EQ(global_cost(-0.58, 0.32), 252);
  EXPECT_EQ(global_cost(-0.58, -0.32), 252);
}

TEST_F(Component, KeepsAContactAsLongAfterTheLastTouch) {
  give_map();
  run(500);
  feel(true);
  base.x -= 1.0;
  run(100);
  feel(false);
  run(50'000);
  base.x += 1.0;
  run(100);
  feel(true);
  base.x -= 1.0;
  run(100);
  feel(false);
  run(20'000);
  feel(false);
  EXPECT_EQ(global_cost(0.42, 0.32), 252) << "more than 60 s after the first touch";
}

TEST_F(Component, AnotherMapHasNoContactsOfTheOneBefore) {
  give_map();
  run(500);
  usher_msgs::msg::Whiskers whiskers;
  whiskers.header(wire::header(last_scan, frames::kBaseLink));
  whiskers.front_left(true);
  host.publish(topics::kWhiskers, whiskers);
  run(1500);
  ASSERT_EQ(global_cost(0.42, 0.32), 252);
  give_map();
  base.x -= 1.0;
  run(100);
  whiskers.header(wire::header(last_scan, frames::kBaseLink));
  whiskers.front_left(false);
  host.publish(topics::kWhiskers, whiskers);
  run(1500);
  EXPECT_LT(global_cost(0.42, 0.32), 252);
}

TEST_F(Component, PlansBesideTheWallThatAWhiskerTouches) {
  map.at(map.geometry().cell_at(0.42, 0.42)) = grid::kOccupied;
  give_map();
  run(500);
  const int before = global_cost(0.42, 0.32);
  usher_msgs::msg::Whiskers whiskers;
  whiskers.header(wire::header(last_scan, frames::kBaseLink));
  whiskers.front_left(true);
  host.publish(topics::kWhiskers, whiskers);
  run(1500);
  EXPECT_EQ(global_cost(0.42, 0.32), before);
  EXPECT_EQ(local_cost(0.42, 0.32), kLethalCost);
}

TEST_F(Component, CountsPeopleOfAnotherFrame) {
  give_map();
  run(500);
  usher_msgs::msg::People people;
  people.header(wire::header(last_scan, frames::kMap));
  host.publish(topics::kPeople, people);
  run(600);
  EXPECT_EQ(host.counter("people: rejected"), 1U);
}

TEST_F(Component, DropsAndCountsLateScansOfItsOwnHost) {
  give_map();
  run(1000);
  auto late = scan("laser", 1.0F);
  late.header(wire::header(host.now() - milliseconds(400), "laser"));
  host.publish(topics::kScanFiltered, late);
  run(600, false);
  EXPECT_EQ(host.counter("scan/filtered: late"), 1U);
  EXPECT_EQ(local_cost(1.0, 0.0), kFreeCost);
}

TEST_F(Component, DropsAndCountsLateScansOfEverySensor) {
  const topics::Topic<sensor_msgs::msg::LaserScan>* const sensors[] = {
      &topics::kUltrasonicFiltered, &topics::kKinectScan, &topics::kKinectScanLow,
      &topics::kRearScan};
  give_map();
  run(1000);
  const auto beside = base.x;
  base.x += 1.0;
  run(700);
  for (const auto* topic : sensors) {
    SCOPED_TRACE(topic->name);
    const std::string counter = std::string(topic->name) + ": late";
    auto old = scan("laser", 1.0F);
    old.header(wire::header(host.now() - milliseconds(400), "laser"));
    host.publish(*topic, old);
    EXPECT_EQ(host.counter(counter), 0U) << "not yet";
    old.header(wire::header(host.now() - milliseconds(900), "laser"));
    host.publish(*topic, old);
    run(100);
    EXPECT_EQ(host.counter(counter), 1U);
  }
  EXPECT_LT(local_cost(beside + 1.0, 0.0), kLethalCost) << "nobody marks what was";
}

TEST_F(Component, CountsWhatItsLayersCannotUse) {
  give_map();
  run(500);
  EXPECT_EQ(host.counter("ranges: invalid"), 0U);
  auto spoilt = scan();
  spoilt.ranges()[3] = std::numeric_limits<float>::quiet_NaN();
  spoilt.ranges()[4] = -1.0F;
  host.publish(topics::kScanFiltered, spoilt);
  run(200);
  EXPECT_EQ(host.counter("ranges: invalid"), 1U) << "NaN says that nothing is known";
  auto sonar = scan("ultrasonic", std::numeric_limits<float>::quiet_NaN());
  sonar.ranges()[3] = -1.0F;
  host.publish(topics::kUltrasonicFiltered, sonar);
  run(200);
  EXPECT_EQ(host.counter("ranges: invalid"), 2U) << "once, though it is placed twice";
  EXPECT_EQ(host.counter("scan: sensor outside"), 0U);
  base.x = 4.5;  // beyond the map's border
  run(500);
  EXPECT_GT(host.counter("scan: sensor outside"), 0U);
}

TEST_F(Component, JudgesNoOtherHostsStampsByItsOwnClock) {
  give_map();
  for (int i = 0; i < 40; ++i) {  // the clock of the scanner's host is 0.4 s behind
    run(40, false);
    auto message = scan("laser", 1.0F);
    message.header(wire::header(host.now() - milliseconds(400), "laser"));
    host.world().publish(topics::kScanFiltered, message, "scan_filter", "sensing");
  }
  EXPECT_EQ(host.counter("scan: late"), 0U);
  EXPECT_EQ(local_cost(1.0, 0.0), kLethalCost);
  // Nor do those who read the costs on this host, and age them by their stamps.
  for (const auto& costs : {host.last(topics::kLocalCosts), host.last(topics::kGlobalCosts)}) {
    ASSERT_TRUE(costs);
    const auto stamp = wire::from_message(costs->header().stamp());
    EXPECT_LE(stamp, host.now());
    EXPECT_LT(host.now() - stamp, milliseconds(1100)) << "the map's costs come once a second";
  }
  const auto local = host.last(topics::kLocalCosts);
  EXPECT_LT(host.now() - wire::from_message(local->header().stamp()), milliseconds(100));
  // Where the robot was at that time, it says on the clock of the scan.
  base.x = 1.0;
  run(200, false);
  auto before = scan("laser", 2.5F);
  before.header(wire::header(host.now() - milliseconds(400), "laser"));
  host.world().publish(topics::kScanFiltered, before, "scan_filter", "sensing");
  run(40, false);
  EXPECT_EQ(local_cost(2.5, 0.0), kLethalCost);
}

TEST_F(Component, PutsTheMapWhereItWasAtTheTimeOfAnotherHostsScan) {
  map.at(map.geometry().cell_at(-1.0, 0.02)) = grid::kOccupied;  // behind: no sensor sees it
  give_map();
  run(1000, false);
  odom.x = 0.5;
  run(200, false);
  auto before = scan();
  before.header(wire::header(host.now() - milliseconds(400), "laser"));
  host.world().publish(topics::kScanFiltered, before, "scan_filter", "sensing");
  run(40, false);
  EXPECT_EQ(local_cost(-1.0, 0.02), kLethalCost);
  EXPECT_LT(local_cost(-1.5, 0.02), kLethalCost);
}

TEST_F(Component, CountsAScanWithoutTheRobotsPose) {
  give_map();
  tf2_msgs::msg::TFMessage fixed;
  fixed.transforms().push_back(
      wire::transform(host.now(), frames::kOdom, "wall scanner", geometry::Pose3{}));
  host.publish(topics::kTfStatic, fixed);
  host.run_for(milliseconds(200));
  host.publish(topics::kScanFiltered, scan("wall scanner"));
  host.run_for(milliseconds(200));
  EXPECT_EQ(host.counter("scan: without pose"), 1U);
}

TEST_F(Component, WhiskersWaitForTheirTransform) {
  give_map();
  run(500);
  usher_msgs::msg::Whiskers whiskers;
  whiskers.header(wire::header(host.now() + milliseconds(30), frames::kBaseLink));
  whiskers.front_left(true);
  host.publish(topics::kWhiskers, whiskers);
  run(200);
  EXPECT_EQ(local_cost(0.4, 0.3), kLethalCost) << "beyond the reach at first";
  whiskers.header(wire::header(host.now() + std::chrono::seconds(5), frames::kBaseLink));
  host.publish(topics::kWhiskers, whiskers);
  run(400);
  EXPECT_EQ(host.counter("tf: dropped"), 1U);
}

TEST_F(Component, RejectsAndCountsNonsense) {
  give_map();
  run(500);
  auto nonsense = scan();
  nonsense.angle_increment(std::numeric_limits<float>::quiet_NaN());
  host.publish(topics::kScanFiltered, nonsense);
  auto no_map = wire::to_message(host.now(), frames::kMap, map);
  no_map.info().resolution(-1.0F);
  host.publish(topics::kMap, no_map);
  run(1000);
  EXPECT_EQ(host.counter("scan: rejected"), 1U);
  EXPECT_EQ(host.counter("map: rejected"), 1U);
  EXPECT_EQ(local_cost(2.0, 0.0), kLethalCost);
}

}  // namespace
}  // namespace usher::costmap
