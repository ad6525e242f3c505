#include "navigation/costmap/shell/component.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "navigation/costmap/test/room.hpp"

namespace usher::costmap {
namespace {

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

TEST_F(Component, SaysThatItsScansCannotBeUsed) {
  give_map();
  run(1500);
  for (int i = 0; i < 50; ++i) {
    host.publish(topics::kScanFiltered, scan("nowhere"));
    run(20, false);
  }
  EXPECT_EQ(reason(), "no scan that can be used");
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
  laser_range = 3.5F;
  for (int i = 0; i < 10; ++i) {
    people.header(wire::header(host.now(), frames::kMap));
    host.publish(topics::kPeople, people);
    host.publish(topics::kKinectScan, scan("laser", 1.1F));
    run(40);
  }
  EXPECT_EQ(local_cost(1.12, 0.0), kLethalCost);
  base.x = 0.4;
  for (int i = 0; i < 5; ++i) host.publish(topics::kKinectScan, scan("laser", kNothing)), run(40);
  EXPECT_LT(local_cost(1.12, 0.0), kLethalCost) << "it may have been somebody";
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
