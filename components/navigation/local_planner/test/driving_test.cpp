// Closed loops: the planner drives a lagging base through worlds; a contact is one of the real
// outline with a real obstacle, not with its cells.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/local_planner/test/world.hpp"

namespace usher::local_planner {
namespace {

using namespace testing_world;  // NOLINT: the test's own vocabulary
using geometry::kPi;

DynamicWindowConfig marvin() {
  DynamicWindowConfig config;
  config.footprint = Footprint::rectangle(0.61, 0.61);
  return config;
}

DynamicWindow planner_for(const DynamicWindowConfig& config, const std::vector<Pose2>& path) {
  DynamicWindow planner = DynamicWindow::make(config).value();
  EXPECT_TRUE(planner.set_path(path).ok());
  return planner;
}

void print(const char* name, const Drive& drive) {
  std::printf(
      "  %-28s reached %d contact %d clearance %.3f m, %.1f s, mean %.2f m/s, fastest %.2f, "
      "reversals %d, "
      "blocked cycles %d, tight cycles %d, end (%.2f %.2f %.2f) %s, closest at (%.2f %.2f %.2f) "
      "when %s\n",
      name, drive.reached, drive.contact, drive.clearance, drive.seconds, drive.mean_speed(),
      drive.fastest, drive.turn_reversals, drive.blocked_cycles, drive.tight_cycles, drive.end.x,
      drive.end.y, drive.end.yaw, to_string(drive.last.reason), drive.closest.x, drive.closest.y,
      drive.closest.yaw, to_string(drive.closest_reason));
}

void expect_arrival(const Drive& drive, const Pose2& goal, const DynamicWindowConfig& config) {
  EXPECT_TRUE(drive.reached);
  EXPECT_FALSE(drive.contact);
  EXPECT_LE(distance(drive.end, goal), config.position_tolerance + 0.03);
  EXPECT_LE(std::abs(geometry::shortest_turn(drive.end.yaw, goal.yaw)),
            config.yaw_tolerance + 0.05);
}

World corridor(double width, double length = 12.0) {
  World world(-2, -3, length, 3);
  world.add(Box{-2, 0.5 * width, length, 0.5 * width + 0.2});
  world.add(Box{-2, -0.5 * width - 0.2, length, -0.5 * width});
  world.finish(0.305);
  return world;
}

TEST(OpenFloor, IsCrossedAtThePace) {
  World world(-3, -4, 15, 4);
  world.finish(0.305);
  const Pose2 goal{10, 0, 0};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
  Base base;
  const Drive result = drive(planner, world, base, 30);
  print("open floor", result);
  expect_arrival(result, goal, marvin());
  EXPECT_NEAR(result.fastest, 1.15, 0.05);
  EXPECT_LT(result.seconds, 17.0);
  EXPECT_EQ(result.turn_reversals, 0);
  EXPECT_LE(result.largest_step, 0.051);  // smooth: the acceleration limit times the cycle
  for (const Pose2& pose : result.trace) EXPECT_LT(std::abs(pose.y), 0.02);
}

class CorridorOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Widths, CorridorOf, testing::Values(1.0, 1.2, 1.4, 2.5));

TEST_P(CorridorOf, IsDrivenWithoutOscillation) {
  const World world = corridor(GetParam());
  const Pose2 goal{9, 0, 0};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
  Base base;
  base.pose = {0, 0.05, 0.1};
  const Drive result = drive(planner, world, base, 40);
  print("corridor", result);
  expect_arrival(result, goal, marvin());
  EXPECT_GT(result.fastest, 1.05);
  EXPECT_LE(result.turn_reversals, 2);
}

struct Door {
  double width;
  Footprint footprint;
  double offset;  // of the door from the grid's lines
};

TEST(DoorsAre, PassedWithoutContact) {
  const std::vector<Door> doors{
      {0.8, Footprint::rectangle(0.61, 0.61), 0.0},  {0.8, Footprint::rectangle(0.61, 0.61), 0.02},
      {0.8, Footprint::rectangle(0.65, 0.65), 0.01}, {0.8, Footprint::rectangle(0.6, 0.7), 0.0},
      {0.8, Footprint::rectangle(0.7, 0.7), 0.0},    {0.9, Footprint::rectangle(0.7, 0.7), 0.03}};
  for (const Door& door : doors) {
    for (const double approach : {0.0, 0.8, -1.2}) {  // the start's offset from the door's axis
      DynamicWindowConfig config = marvin();
      config.footprint = door.footprint;
      World world(-3, -4, 7, 4);
      world.add(Box{1.9, door.offset + 0.5 * door.width, 2.1, 4});
      world.add(Box{1.9, -4, 2.1, door.offset - 0.5 * door.width});
      world.finish(door.footprint.inscribed_radius(), door.footprint.circumscribed_radius() + 0.3,
                   4.0);
      const Pose2 start{-1, approach, 0};
      const Pose2 goal{5, door.offset, 0};
      const auto path = world.plan(start, goal, 8.0);
      ASSERT_TRUE(path) << door.width;
      DynamicWindow planner = planner_for(config, *path);
      Base base;
      base.pose = start;
      const Drive result = drive(planner, world, base, 60);
      print("door", result);
      expect_arrival(result, goal, config);
      EXPECT_LE(result.turn_reversals, 5);
      // A square that fills the door but for 5 cm a side may have to straighten up; others never
      // wait.
      const bool fills = door.footprint.circumscribed_radius() > 0.46;
      EXPECT_LE(result.blocked_cycles, fills ? 60 : 0);
    }
  }
}

TEST(Doors, BesideACorridorArePassedBothWays) {
  // A 1.2 m corridor along x with a 0.8 m door in its side wall at x = 3, into a room below.
  World world(-2, -5, 8, 2);
  world.add(Box{-2, 0.6, 8, 0.8});
  world.add(Box{-2, -0.75, 2.6, -0.6});
  world.add(Box{3.4, -0.75, 8, -0.6});
  world.finish(0.305);
  const Pose2 outside{0, 0, 0};
  const Pose2 inside{3, -3, -kPi / 2};
  for (const bool in : {true, false}) {
    const Pose2 start = in ? outside : Pose2{3, -3, kPi / 2};
    const Pose2 goal = in ? inside : Pose2{0, 0, kPi};
    const auto path = world.plan(start, goal);
    ASSERT_TRUE(path);
    DynamicWindow planner = planner_for(marvin(), *path);
    Base base;
    base.pose = start;
    const Drive result = drive(planner, world, base, 60);
    print(in ? "door from corridor" : "door to corridor", result);
    expect_arrival(result, goal, marvin());
  }
}

TEST(BesideAWall, ARobotThatCannotTurnThereTurnsOnAnArc) {
  DynamicWindowConfig config;  // the Pioneer, whose rear corners would meet the wall
  config.footprint = Footprint::rectangle(0.455, 0.381);
  config.pace = 0.7;
  config.fastest_turn = config.spot_turn = 0.4;
  for (const double room : {0.08, 0.1, 0.12}) {
    World world(-6, -4, 10, 1);
    world.add(Box{-6, 0.1905 + room, 10, 1});
    world.finish(config.footprint.inscribed_radius());
    const Pose2 goal{-4, -0.5, kPi};
    DynamicWindow planner = planner_for(config, {{0, 0, 0}, goal});
    Base base;
    const Drive result = drive(planner, world, base, 60);
    print("path behind, wall beside", result);
    expect_arrival(result, goal, config);
    double farthest = 0.0;
    for (const Pose2& pose : result.trace) farthest = std::max(farthest, pose.x);
    EXPECT_LT(farthest, 1.5);
  }
}

World corner(double width) {
  World world(-2, -2, 8, 8);
  const double half = 0.5 * width;
  world.add(Box{-2, -half - 0.2, 5 + half, -half});  // below the first leg
  world.add(Box{-2, half, 5 - half, half + 0.2});    // above it
  world.add(Box{5 + half, -half - 0.2, 5 + half + 0.2, 8});
  world.add(Box{5 - half - 0.2, half, 5 - half, 8});
  world.finish(0.305);
  return world;
}

class CornerOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Widths, CornerOf, testing::Values(1.2, 1.4, 2.0));

TEST_P(CornerOf, IsTakenOnAPlannedPath) {
  const World world = corner(GetParam());
  const Pose2 start{0, 0, 0};
  const Pose2 goal{5, 5, kPi / 2};
  DynamicWindow planner = planner_for(marvin(), world.plan(start, goal).value());
  Base base;
  const Drive result = drive(planner, world, base, 60);
  print("corner, planned path", result);
  expect_arrival(result, goal, marvin());
  EXPECT_LE(result.turn_reversals, 4);
}

TEST_P(CornerOf, IsTakenOnASharpPath) {
  const World world = corner(GetParam());
  const Pose2 goal{5, 5, kPi / 2};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, {5, 0, 0}, goal});
  Base base;
  const Drive result = drive(planner, world, base, 60);
  print("corner, sharp path", result);
  expect_arrival(result, goal, marvin());
}

TEST_P(CornerOf, IsTakenWithADeadTimeAndALagThatThePlannerUnderestimates) {
  const World world = corner(GetParam());
  const Pose2 start{0, 0, 0};
  const Pose2 goal{5, 5, kPi / 2};
  DynamicWindow planner = planner_for(marvin(), world.plan(start, goal).value());
  Base base;
  base.dead_time = 0.2;
  base.lag = 0.8;
  const Drive result = drive(planner, world, base, 60);
  print("corner, slow base", result);
  expect_arrival(result, goal, marvin());
}

TEST_P(CornerOf, IsTakenByABaseThatAnswersAsLateAsABalancingOne) {
  const World world = corner(GetParam());
  const Pose2 start{0, 0, 0};
  const Pose2 goal{5, 5, kPi / 2};
  DynamicWindowConfig config = marvin();
  config.response.latency = 0.75;
  config.pace = GetParam() < 1.3 ? 0.8 : 1.0;  // MARVIN's limits in such corridors
  DynamicWindow planner = planner_for(config, world.plan(start, goal).value());
  Base base;
  base.dead_time = 0.7;
  const Drive result = drive(planner, world, base, 60);
  print("corner, late base", result);
  expect_arrival(result, goal, config);
  EXPECT_LE(result.turn_reversals, 6);  // it weaves a little: the dead time holds for turns too
}

TEST(GoalBehind, IsReachedByTurningFirst) {
  World world(-8, -4, 4, 4);
  world.finish(0.305);
  const Pose2 goal{-5, 0, kPi / 2};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, kPi}, goal});
  Base base;
  const Drive result = drive(planner, world, base, 40);
  print("goal behind", result);
  expect_arrival(result, goal, marvin());
  double forward = 0.0;
  double sideways = 0.0;
  for (const Pose2& pose : result.trace) {
    forward = std::max(forward, pose.x), sideways = std::max(sideways, std::abs(pose.y));
  }
  EXPECT_LT(forward, 0.05);
  EXPECT_LT(sideways, 0.15);
}

TEST(GoalBehind, InACorridorIsReachedToo) {
  const World world = corridor(1.2);
  const Pose2 goal{1, 0, kPi};
  DynamicWindow planner = planner_for(marvin(), {{6, 0, 0}, goal});
  Base base;
  base.pose = {6, 0, 0};
  const Drive result = drive(planner, world, base, 40);
  print("goal behind in corridor", result);
  expect_arrival(result, goal, marvin());
}

TEST(GoalYaw, IsTurnedToOnTheSpot) {
  World world(-4, -4, 4, 4);
  world.finish(0.305);
  for (const double yaw : {-3.0, -1.5, 0.05, 1.5, 3.1}) {
    const Pose2 goal{0.02, 0.0, yaw};
    DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
    Base base;
    const Drive result = drive(planner, world, base, 20);
    expect_arrival(result, goal, marvin());
    EXPECT_EQ(result.way, 0.0);
  }
}

class BlockedBy : public testing::TestWithParam<double> {};  // the dead time of the base
INSTANTIATE_TEST_SUITE_P(DeadTimes, BlockedBy, testing::Values(0.0, 0.3, 0.7));

TEST_P(BlockedBy, AWallItStopsBeforeItAndSaysSo) {
  World world = corridor(1.4);
  world.add(Box{6, -1, 6.2, 1});
  world.finish(0.305);
  DynamicWindowConfig config = marvin();
  config.response.latency = 0.05 + GetParam();
  DynamicWindow planner = planner_for(config, {{0, 0, 0}, {10, 0, 0}});
  Base base;
  base.dead_time = GetParam();
  const Drive result = drive(planner, world, base, 40, 3.0);
  print("blocked corridor", result);
  EXPECT_FALSE(result.reached);
  EXPECT_FALSE(result.contact);
  EXPECT_TRUE(result.last.blocked);
  EXPECT_EQ(result.last.reason, Reason::kBlocked);
  EXPECT_EQ(result.last.command, (Twist2{0, 0}));
  EXPECT_GT(result.fastest, 1.1);
  const double gap = 6.0 - 0.305 - result.end.x;
  EXPECT_GT(gap, 0.08);
  EXPECT_LT(gap, 0.6);
  EXPECT_NEAR(result.last.obstacle_distance, gap, 0.1);
}

TEST(AChair, IsPassedOnAPlanThatKnowsItAndWaitedAtElse) {
  // The thesis' 1.4 m corridor would leave no room beside a 0.6 m chair at the wall but 0.8 m: like
  // a door.
  World world = corridor(1.4);
  world.add(Disc{4.0, 0.4, 0.3});
  world.finish(0.305);
  const Pose2 goal{9, 0, 0};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});  // does not know the chair
  Base base;
  Drive result = drive(planner, world, base, 20);
  print("chair, path through it", result);
  EXPECT_FALSE(result.reached);
  EXPECT_FALSE(result.contact);
  EXPECT_TRUE(result.last.blocked);
  EXPECT_LT(result.last.obstacle_distance, 2.0);

  // From where it waits the navigator plans anew.
  ASSERT_TRUE(planner.set_path(world.plan(base.pose, goal).value()).ok());
  result = drive(planner, world, base, 60);
  print("chair, path around it", result);
  expect_arrival(result, goal, marvin());
}

TEST(AChair, IsDrivenAroundWithRoom) {
  World world = corridor(3.0);
  world.add(Disc{4.0, 0.2, 0.3});
  world.finish(0.305);
  const Pose2 goal{9, 0, 0};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
  Base base;
  const Drive result = drive(planner, world, base, 60);
  print("chair, room beside it", result);
  expect_arrival(result, goal, marvin());
}

TEST(APerson, WhoCrossesIsNotHit) {
  World world(-3, -5, 12, 5);
  world.finish(0.305);
  const Pose2 goal{8, 0, 0};
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < 16; ++i) {
      const double meets = 2.0 + 0.25 * i;
      DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
      Base base;
      const std::vector<MovingDisc> people{{{meets, 3.0 * side}, {0.0, -0.7 * side}, 0.3}};
      const Drive result = drive(planner, world, base, 40, 5.0, 6.0, people);
      EXPECT_TRUE(result.reached) << meets;
      EXPECT_FALSE(result.contact) << meets;
    }
  }
}

TEST(APerson, WhoStandsInTheWayIsDrivenAround) {
  World world(-3, -5, 12, 5);
  world.finish(0.305);
  const Pose2 goal{8, 0, 0};
  DynamicWindow planner = planner_for(marvin(), {{0, 0, 0}, goal});
  Base base;
  const std::vector<MovingDisc> people{{{4.0, 0.05}, {0.0, 0.0}, 0.3}};
  const Drive result = drive(planner, world, base, 40, 10.0, 6.0, people);
  print("person in the way", result);
  EXPECT_TRUE(result.reached);
  EXPECT_FALSE(result.contact);
}

TEST(ClutteredRooms, AreCrossedWithoutContact) {
  int arrivals = 0;
  int contacts = 0;
  int worlds = 0;
  double speed = 0.0;
  for (std::uint64_t seed = 1; worlds < 100; ++seed) {
    Random random(seed);
    World world(0, 0, 10, 8);
    for (const Box& wall :
         {Box{0, 0, 10, 0.1}, Box{0, 7.9, 10, 8}, Box{0, 0, 0.1, 8}, Box{9.9, 0, 10, 8}}) {
      world.add(wall);
    }
    const Pose2 start{1, 1, random.uniform(-kPi, kPi)};
    const Pose2 goal{9, 7, random.uniform(-kPi, kPi)};
    for (int i = 0; i < 22; ++i) {
      const Disc disc{random.uniform(0.3, 9.7), random.uniform(0.3, 7.7),
                      random.uniform(0.05, 0.4)};
      if (std::hypot(disc.x - start.x, disc.y - start.y) < 0.9 + disc.radius) continue;
      if (std::hypot(disc.x - goal.x, disc.y - goal.y) < 0.9 + disc.radius) continue;
      world.add(disc);
    }
    world.finish(0.36);  // the planner above keeps a little away, as every well set up one does
    const auto path = world.plan(start, goal);
    if (!path) continue;
    ++worlds;
    DynamicWindow planner = planner_for(marvin(), *path);
    Base base;
    base.pose = start;
    const Drive result = drive(planner, world, base, 90);
    arrivals += result.reached;
    contacts += result.contact;
    speed += result.mean_speed();
    if (!result.reached || result.contact) {
      std::printf("  seed %d", static_cast<int>(seed));
      print("", result);
    }
  }
  std::printf("  arrivals %d, contacts %d of %d rooms, mean speed %.2f m/s\n", arrivals, contacts,
              worlds, speed / worlds);
  EXPECT_EQ(contacts, 0);
  EXPECT_GE(arrivals, 98);
}

}  // namespace
}  // namespace usher::local_planner
