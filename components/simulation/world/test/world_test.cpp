#include "simulation/world/core/world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace usher::world {
namespace {

using testing::HasSubstr;

/// A hall of 20 x 6 m with a door in the middle of its dividing wall.
Building hall() {
  const auto building = parse_building(R"(name: hall
walls:
  - {name: outer, thickness: 0.2, points: [[0, 0], [20, 0], [20, 6], [0, 6], [0, 0]]}
  - {name: middle, thickness: 0.1, points: [[10, 0], [10, 6]]}
doors:
  - {name: door, at: [10, 3], width: 1.0}
)",
                                       "hall.yaml");
  EXPECT_TRUE(building.ok());
  return *building;
}

void drive(World& world, double v, double w, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds / kStep); ++i) {
    world.base().command({v, w});
    world.step();
  }
}

PersonPlan stands(const char* name, double x, double y) {
  PersonPlan plan;
  plan.name = name;
  plan.start = {x, y};
  return plan;
}

TEST(World, CountsOneContactForOneCrash) {
  World world({}, hall(), {}, {5.0, 1.2, 0.0}, 1);
  drive(world, 0.8, 0.0, 12.0);
  EXPECT_EQ(world.truth().contacts, 1U);
  EXPECT_EQ(world.truth().touches, 0U);
  EXPECT_EQ(world.truth().contact_with, "middle");
  EXPECT_LT(world.base().truth().pose.x + 0.33, 9.95) << "the wall stands firm";
  EXPECT_GT(world.base().truth().pose.x + 0.33, 9.85);
}

TEST(World, DrivesAwayAfterACrash) {
  World world({}, hall(), {}, {5.0, 1.2, 0.0}, 1);
  drive(world, 0.8, 0.0, 12.0);
  drive(world, -0.4, 0.0, 6.0);
  EXPECT_LT(world.base().truth().pose.x, 9.0);
  EXPECT_GT(world.truth().clearance, 0.3);
}

TEST(World, PassesAnOpenDoorAndNotAClosedOne) {
  World world({}, hall(), {}, {8.0, 3.0, 0.0}, 1);
  drive(world, 0.5, 0.0, 8.0);
  EXPECT_GT(world.base().truth().pose.x, 11.0);
  EXPECT_EQ(world.truth().contacts, 0U);

  World closed({}, hall(), {}, {8.0, 3.0, 0.0}, 1);
  ASSERT_TRUE(closed.set_door("door", false).ok());
  drive(closed, 0.5, 0.0, 8.0);
  EXPECT_LT(closed.base().truth().pose.x, 10.0);
  EXPECT_EQ(closed.truth().contact_with, "door door");
  EXPECT_THAT(closed.set_door("gate", true).error(), HasSubstr("'gate'"));
}

TEST(World, MeasuresClearanceWithin2Metres) {
  World world({}, hall(), {}, {5.0, 1.0, 0.0}, 1);
  EXPECT_NEAR(world.truth().clearance, 1.0 - 0.1 - 0.35, 1e-6);
  EXPECT_EQ(world.truth().nearest, "outer");
  ASSERT_TRUE(world.place_robot({5.0, 3.0, 0.0}).ok());
  EXPECT_TRUE(std::isinf(world.truth().clearance));
}

TEST(World, RefusesToPlaceTheRobotInAWall) {
  World world({}, hall(), {}, {5.0, 3.0, 0.0}, 1);
  EXPECT_THAT(world.place_robot({10.0, 1.0, 0.0}).error(), HasSubstr("'middle'"));
  EXPECT_FALSE(world.place_robot({std::nan(""), 1.0, 0.0}).ok());
  EXPECT_TRUE(world.place_robot({15.0, 3.0, 0.0}).ok());
  EXPECT_EQ(world.base().truth().pose.x, 15.0);
}

TEST(World, AThingThatAppearsLateIsATouch) {
  World world({}, hall(), {}, {3.0, 3.0, 0.0}, 1);
  drive(world, 1.0, 0.0, 4.0);
  const double x = world.base().truth().pose.x;
  ASSERT_TRUE(world.add_thing(disc("ball", {x + 1.0, 3.0}, 0.2, 0.0, 1.0)).ok());
  EXPECT_FALSE(world.add_thing(disc("ball", {1.0, 1.0}, 0.2, 0.0, 1.0)).ok());
  drive(world, 1.0, 0.0, 1.5);
  EXPECT_EQ(world.truth().contacts, 0U);
  EXPECT_EQ(world.truth().touches, 1U);
  ASSERT_TRUE(world.remove_thing("ball").ok());
  EXPECT_FALSE(world.remove_thing("ball").ok());
}

TEST(World, RunningIntoSomebodyLongSeenIsAContact) {
  // A person in a dead end cannot step aside.
  const PersonPlan person = stands("eve", 19.5, 3.0);
  World world({}, hall(), std::span(&person, 1), {14.0, 3.0, 0.0}, 1);
  drive(world, 1.0, 0.0, 9.0);
  EXPECT_EQ(world.truth().contacts + world.truth().touches, 1U);
  EXPECT_EQ(world.truth().contacts, 1U);
}

TEST(World, PeopleStepOutOfTheWay) {
  const PersonPlan person = stands("eve", 6.0, 3.1);
  World world({}, hall(), std::span(&person, 1), {2.0, 3.0, 0.0}, 1);
  drive(world, 0.6, 0.0, 9.0);
  EXPECT_EQ(world.truth().contacts + world.truth().touches, 0U);
  EXPECT_GT(world.base().truth().pose.x, 6.0);
}

TEST(World, WalkersPassTheRobotInACorridor) {
  PersonPlan walker = stands("ada", 0.0, 0.0);
  walker.loop = {{1.0, 3.0}, {9.0, 3.0}};
  int passed = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    World world({}, hall(), std::span(&walker, 1), {5.0, 3.0, 0.0}, seed);
    double lowest = 9.0;
    double highest = 0.0;
    for (int i = 0; i < 3000; ++i) {
      world.step();
      lowest = std::min(lowest, world.people()[0].position.x());
      highest = std::max(highest, world.people()[0].position.x());
    }
    EXPECT_EQ(world.truth().contacts + world.truth().touches, 0U) << seed;
    passed += lowest < 2.0 && highest > 8.0 ? 1 : 0;
  }
  EXPECT_GE(passed, 9);
}

TEST(World, WalkersKeepTheirSpeed) {
  PersonPlan walker = stands("ada", 0.0, 0.0);
  walker.loop = {{1.0, 3.0}, {9.0, 3.0}};
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    World world({}, hall(), std::span(&walker, 1), {15.0, 3.0, 0.0}, seed);
    for (int i = 0; i < 1000; ++i) {
      world.step();
      sum += world.people()[0].velocity.norm();
      ++count;
    }
  }
  EXPECT_NEAR(sum / count, 1.15, 0.12);
}

TEST(World, AScriptedPersonGoesWhereItIsSent) {
  const PersonPlan person = stands("visitor", 3.0, 3.0);
  World world({}, hall(), std::span(&person, 1), {15.0, 5.0, 0.0}, 1);
  ASSERT_TRUE(world.send_person("visitor", {8.0, 1.5}, 1.2, false).ok());
  drive(world, 0.0, 0.0, 8.0);
  EXPECT_LT((world.people()[0].position - Point2(8.0, 1.5)).norm(), 0.3);
  EXPECT_LT(world.people()[0].velocity.norm(), 0.2);
  EXPECT_FALSE(world.send_person("nobody", {1.0, 1.0}, 1.0, false).ok());
  EXPECT_FALSE(world.send_person("visitor", {std::nan(""), 1.0}, 1.0, false).ok());
  EXPECT_FALSE(world.send_person("visitor", {1.0, 1.0}, 9.0, false).ok());
}

TEST(World, AVisitorFollowsThroughTheDoorWithoutTouching) {
  const PersonPlan person = stands("visitor", 3.0, 3.0);
  World world({}, hall(), std::span(&person, 1), {5.0, 3.0, 0.0}, 1);
  ASSERT_TRUE(world.send_person("visitor", {0.0, 0.0}, 1.4, true).ok());
  drive(world, 0.9, 0.0, 11.0);
  drive(world, 0.0, 0.0, 5.0);
  const double behind = world.base().truth().pose.x - world.people()[0].position.x();
  EXPECT_GT(world.base().truth().pose.x, 12.0);
  EXPECT_GT(behind, 0.6);
  EXPECT_LT(behind, 2.0);
  EXPECT_EQ(world.truth().contacts + world.truth().touches, 0U);
}

TEST(World, PeopleNeverStandInWalls) {
  std::vector<PersonPlan> people;
  for (int i = 0; i < 8; ++i) {
    PersonPlan plan = stands(("p" + std::to_string(i)).c_str(), 0, 0);
    plan.loop = {
        {1.0, 1.0 + 0.5 * i}, {19.0, 3.0}, {19.0, 1.0 + 0.5 * i}, {12.0, 3.0}, {10.0, 3.0}};
    people.push_back(plan);
  }
  World world({}, hall(), people, {15.0, 1.0, 1.0}, 3);
  for (int i = 0; i < 6000; ++i) {
    world.step();
    if (i % 50 != 0) continue;
    for (const Person& person : world.people()) {
      ASSERT_TRUE(person.position.allFinite());
      ASSERT_GT(world.scene().nearest(person.position, 1.7, 1.0).distance, 0.1) << person.name;
    }
  }
}

TEST(World, IsMadeFromAnOccupancyMap) {
  grid::OccupancyGrid map({.width = 200, .height = 60, .resolution = 0.1});
  for (int x = 0; x < 200; ++x) map.at({x, 0}) = map.at({x, 59}) = grid::kOccupied;
  for (int y = 0; y < 60; ++y) map.at({0, y}) = map.at({199, y}) = grid::kOccupied;
  World world({}, map, {}, {5.0, 3.0, 0.0}, 1);
  std::vector<float> ranges;
  world.scan(0, ranges);
  EXPECT_NEAR(ranges[270], 19.9 - 5.28, 0.08);
  drive(world, 1.0, 0.0, 20.0);
  EXPECT_EQ(world.truth().contact_with, "map");
  EXPECT_TRUE(world.add_thing(disc("ball", {3.0, 3.0}, 0.2, 0.0, 1.0)).ok());
}

TEST(World, PioneerDrivesInItToo) {
  WorldConfig config;
  config.robot.kind = RobotConfig::Kind::kPioneer;
  World world(config, hall(), {}, {3.0, 3.0, 0.0}, 1);
  drive(world, 0.5, 0.0, 4.0);
  EXPECT_NEAR(world.base().truth().pose.x, 4.75, 0.3);
  EXPECT_EQ(world.base().truth().pitch, 0.0);
}

TEST(World, RepeatsEveryBitOfASeed) {
  std::vector<PersonPlan> people{stands("a", 3, 2)};
  people[0].loop = {{1.0, 1.0}, {9.0, 5.0}};
  const auto run = [&](std::uint64_t seed) {
    World world({}, hall(), people, {5.0, 3.0, 0.0}, seed);
    std::vector<float> all;
    std::vector<float> ranges;
    for (int i = 0; i < 500; ++i) {
      world.base().command({0.4, 0.3});
      world.step();
      if (i % 2 == 0) world.scan(0, ranges), all.insert(all.end(), ranges.begin(), ranges.end());
      if (i % 25 == 0) world.sonar(ranges), all.insert(all.end(), ranges.begin(), ranges.end());
      all.push_back(static_cast<float>(world.people()[0].position.x()));
      all.push_back(static_cast<float>(world.base().readings().left_travel));
    }
    return all;
  };
  EXPECT_EQ(run(4), run(4));
  EXPECT_NE(run(4), run(5));
}

OtherRobot pioneer_at(const Pose2& pose) {
  return {"otto", pose, {{-0.228, -0.191}, {0.228, -0.191}, {0.228, 0.191}, {-0.228, 0.191}}, 1.2};
}

TEST(TwoRobots, SeeEachOtherInTheirLasers) {
  World world({}, hall(), {}, {3.0, 2.0, 0.0}, 1);
  std::vector<float> ranges;
  const auto ahead = [&] {
    world.scan(0, ranges);
    return static_cast<double>(ranges[ranges.size() / 2]);
  };
  const double wall = ahead();
  world.show_robots({pioneer_at({6.0, 2.0, 0.0})});
  EXPECT_GT(wall, 5.0);
  const double laser = world.config().robot.lasers.front().mount.x;
  EXPECT_NEAR(ahead(), 6.0 - 0.228 - 3.0 - laser, 0.1);
  world.show_robots({pioneer_at({6.0, 4.0, 0.0})});
  EXPECT_NEAR(ahead(), wall, 0.1);
}

TEST(TwoRobots, StopEachOtherAndThatIsAContact) {
  World world({}, hall(), {}, {3.0, 2.0, 0.0}, 1);
  world.show_robots({pioneer_at({6.0, 2.0, 0.0})});
  drive(world, 0.8, 0.0, 8.0);
  EXPECT_EQ(world.truth().contacts, 1U);
  EXPECT_EQ(world.truth().contact_with, "otto");
  EXPECT_LT(world.base().truth().pose.x + 0.33, 6.0 - 0.22);
  drive(world, -0.4, 0.0, 4.0);
  EXPECT_LT(world.base().truth().pose.x, 5.0) << "and it may drive away";
}

TEST(TwoRobots, LetGoOfEachOtherWhoEverCameTooNear) {
  World world({}, hall(), {}, {3.0, 2.0, 0.0}, 1);
  world.show_robots({pioneer_at({3.5, 2.0, 0.0})});  // it drove into this one
  drive(world, -0.4, 0.0, 4.0);
  EXPECT_LT(world.base().truth().pose.x, 2.5);
}

TEST(TwoRobots, HaveTheSamePeople) {
  const std::vector<PersonPlan> plans{stands("ada", 6.0, 1.0)};
  World first({.name = "iris"}, hall(), plans, {3.0, 2.0, 0.0}, 1);
  World second({.name = "otto", .moves_people = false}, hall(), {}, {8.0, 4.5, 0.0}, 2);
  const auto exchange = [&] {
    first.show_robots({{"otto", second.base().truth().pose, pioneer_at({}).outline, 1.2}});
    second.show_robots({{"iris", first.base().truth().pose, pioneer_at({}).outline, 1.2}});
    const auto people = first.people();
    const auto bodies = first.bodies();
    second.show_people({people.begin(), people.end()}, {bodies.begin(), bodies.end()});
  };
  exchange();
  ASSERT_EQ(second.people().size(), 1U);
  ASSERT_TRUE(first.send_person("ada", {0, 0}, 1.2, true, "otto").ok());
  for (int i = 0; i < 800; ++i) {
    first.step();
    second.step();
    exchange();
  }
  const Point2 ada = second.people()[0].position;
  EXPECT_EQ(ada, first.people()[0].position);
  EXPECT_LT((ada - second.base().truth().pose.position()).norm(), 2.0) << "it follows otto";
}

TEST(TwoRobots, AreWithTheirPeopleWhereTheyWereWhenTheirWorldFallsSilent) {
  World first({.name = "iris"}, hall(), std::vector{stands("ada", 6.0, 1.0)}, {3.0, 2.0, 0.0}, 1);
  World second({.name = "otto", .moves_people = false}, hall(), {}, {3.0, 2.0, 0.0}, 2);
  ASSERT_TRUE(first.send_person("ada", {9.0, 1.0}, 1.2, false, "").ok());
  for (int i = 0; i < 50; ++i) first.step();
  const auto people = first.people();
  const auto bodies = first.bodies();
  ASSERT_GT(people[0].velocity.norm(), 0.5) << "on the way";
  second.show_people({people.begin(), people.end()}, {bodies.begin(), bodies.end()});
  second.show_robots({pioneer_at({6.0, 2.0, 0.0})});
  const Point2 ada = second.people()[0].position;
  std::vector<float> ranges;
  const auto ahead = [&] {
    second.scan(0, ranges);
    return static_cast<double>(ranges[ranges.size() / 2]);
  };
  const double otto = ahead();
  for (int i = 0; i < 500; ++i) second.step();
  EXPECT_EQ(second.people()[0].position, ada);
  EXPECT_NEAR(ahead(), otto, 0.3) << "this one sways";
}

TEST(TwoRobots, AreWatchedOneAtATime) {
  PersonPlan plan = stands("ada", 6.0, 2.0);
  plan.watches = true;
  World world({.name = "iris"}, hall(), std::vector{plan}, {3.0, 2.0, 0.0}, 1);
  world.show_robots({pioneer_at({7.5, 2.0, 0.0})});
  drive(world, 0.0, 0.0, 3.0);
  EXPECT_NEAR(world.people()[0].yaw, 0.0, 0.1) << "the nearer one";
  ASSERT_TRUE(world.send_person("ada", {6.0, 2.0}, 0.0, false, "iris").ok());
  drive(world, 0.0, 0.0, 3.0);
  EXPECT_NEAR(std::abs(world.people()[0].yaw), geometry::kPi, 0.1) << "the one that spoke";
}

}  // namespace
}  // namespace usher::world
