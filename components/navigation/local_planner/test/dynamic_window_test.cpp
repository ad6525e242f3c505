#include "navigation/local_planner/core/dynamic_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/local_planner/test/world.hpp"

namespace usher::local_planner {
namespace {

using kinematics::Whiskers;
using namespace testing_world;  // NOLINT: the test's own vocabulary

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

int sign(double value) { return static_cast<int>(value > 0.0) - static_cast<int>(value < 0.0); }

Costs empty_window() { return Costs({120, 120, 0.05, -3.0, -3.0}); }

/// A wall across the way: its face at x.
Costs wall_at(double x) {
  World world(-3, -3, 3, 3);
  world.add(Box{x, -3, x + 0.1, 3});
  world.finish(0.305);
  return world.costs();
}

DynamicWindow planner_to(double x, const DynamicWindowConfig& config = {},
                         cpu::Simd simd = cpu::best_simd()) {
  DynamicWindow planner = DynamicWindow::make(config, simd).value();
  EXPECT_TRUE(planner.set_path(std::vector<Pose2>{{0, 0, 0}, {x, 0, 0}}).ok());
  return planner;
}

Footprint marvin() {
  const std::vector<Point2> outline{{0.305, 0.33}, {-0.305, 0.33}, {-0.305, -0.33}, {0.305, -0.33}};
  return Footprint::make(outline).value();
}

TEST(Configuration, NamesTheValueThatIsOutOfRange) {
  DynamicWindowConfig config;
  config.pace = 0.0;
  EXPECT_NE(DynamicWindow::make(config).error().find("pace"), std::string::npos);
  config = {};
  config.steps = 400;
  EXPECT_NE(DynamicWindow::make(config).error().find("steps"), std::string::npos);
  config = {};
  config.weights.goal = -1.0;
  EXPECT_FALSE(DynamicWindow::make(config).ok());
  config = {};
  config.response.time_constant = kNaN;
  EXPECT_FALSE(DynamicWindow::make(config).ok());
}

TEST(Configuration, DefaultIsValid) { EXPECT_TRUE(DynamicWindow::make({}).ok()); }

TEST(Decide, StandsWithoutAPath) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  const Decision decision = planner.decide(empty_window(), {}, {}, {}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kNoPath);
  EXPECT_EQ(decision.command, (Twist2{0, 0}));
  EXPECT_FALSE(decision.reached);
}

TEST(Decide, RampsToAStopWhenThePathIsTaken) {
  DynamicWindow planner = planner_to(8.0);
  planner.clear_path();
  const Decision decision = planner.decide(empty_window(), {}, {1.0, 0}, {1.0, 0}, 0.05);
  EXPECT_NEAR(decision.command.v, 0.95, 1e-12);
}

TEST(Decide, StopsOnInputThatIsNotFinite) {
  const Costs costs = empty_window();
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300}) {
    DynamicWindow planner = planner_to(8.0);
    for (const Pose2& pose : {Pose2{bad, 0, 0}, Pose2{0, bad, 0}}) {
      const Decision decision = planner.decide(costs, pose, {}, {}, 0.05);
      EXPECT_EQ(decision.reason, Reason::kInvalidInput);
      EXPECT_EQ(decision.command, (Twist2{0, 0}));
    }
    EXPECT_EQ(planner.decide(costs, {}, {bad, 0}, {}, 0.05).reason, Reason::kInvalidInput);
    EXPECT_EQ(planner.decide(costs, {}, {}, {0, bad}, 0.05).reason, Reason::kInvalidInput);
    const std::vector<MovingDisc> discs{{{bad, 0}, {0, bad}, bad}};
    EXPECT_EQ(planner.decide(costs, {}, {}, {}, 0.05, discs).reason, Reason::kInvalidInput);
  }
}

TEST(Decide, StopsOnAGridThatCannotBeUsed) {
  DynamicWindow planner = planner_to(8.0);
  EXPECT_EQ(planner.decide(Costs{}, {}, {}, {}, 0.05).reason, Reason::kInvalidInput);
  EXPECT_EQ(planner.decide(Costs({10, 10, 0.0, 0, 0}), {}, {}, {}, 0.05).reason,
            Reason::kInvalidInput);
  EXPECT_EQ(planner.decide(Costs({10, 10, 0.05, kNaN, 0}), {}, {}, {}, 0.05).reason,
            Reason::kInvalidInput);
  EXPECT_EQ(planner.decide(Costs({10, 10, 0.05, 50, 50}), {}, {}, {}, 0.05).reason,
            Reason::kInvalidInput);
}

TEST(Decide, KeepsTheCommandWhenNoTimeHasPassed) {
  DynamicWindow planner = planner_to(8.0);
  for (const double seconds : {0.0, -1.0, kNaN}) {
    EXPECT_EQ(planner.decide(empty_window(), {}, {0.5, 0}, {0.5, 0}, seconds).command.v, 0.5);
  }
}

TEST(Decide, DoesNotLeapAfterAGap) {
  DynamicWindow planner = planner_to(8.0);
  EXPECT_LE(planner.decide(empty_window(), {}, {}, {}, 60.0).command.v, 0.2 + 1e-12);
}

TEST(Decide, NeverAsksForASpeedThatCannotBeStoppedBeforeTheWall) {
  const kinematics::StoppingDistance stopping;
  for (int i = 0; i < 19; ++i) {
    const double wall = 0.5 + 0.1 * i;
    for (const double v : {0.0, 0.3, 0.6, 1.0}) {
      DynamicWindow planner = planner_to(8.0);
      const Decision decision = planner.decide(wall_at(wall), {}, {v, 0}, {v, 0}, 0.05);
      if (decision.blocked) continue;
      EXPECT_LE(stopping.distance(decision.target.v), wall - 0.305) << wall << ' ' << v;
    }
  }
}

TEST(Decide, IsSlowWhereARobotThatIsStoppedBeforeItsTurnWouldMeetAWall) {
  DynamicWindowConfig config;
  config.limits.angular_acceleration = 0.4;  // what is planned bends more than what is driven yet
  World world(-3, -3, 3, 3);
  world.add(Box{-3, 1.2, 3, 1.3});
  world.finish(0.305);
  const auto target = [&](const Twist2& moves) {
    return planner_to(8.0, config).decide(world.costs(), {0, 0, 0.6}, moves, moves, 0.05).target.v;
  };
  EXPECT_LT(target({0.8, 0.0}), 0.7);
  EXPECT_GT(target({0.8, -0.3}), 1.1) << "it turns already";
}

TEST(Decide, KeepsThePaceWhereTheWindowEnds) {
  const Costs small({60, 60, 0.05, -1.5, -1.5});
  EXPECT_GT(planner_to(8.0).decide(small, {}, {0.5, 0}, {0.5, 0}, 0.05).target.v, 0.5);
}

TEST(Decide, KeepsThePaceWhereItCanBeStopped) {
  DynamicWindow planner = planner_to(8.0);
  EXPECT_NEAR(planner.decide(empty_window(), {}, {1.15, 0}, {1.15, 0}, 0.05).target.v, 1.15, 1e-12);
  ASSERT_TRUE(planner.set_pace(0.6).ok());
  EXPECT_NEAR(planner.decide(empty_window(), {}, {0.6, 0}, {0.6, 0}, 0.05).target.v, 0.6, 1e-12);
  EXPECT_FALSE(planner.set_pace(kNaN).ok());
}

TEST(Decide, ReportsTheDistanceToTheObstacleOnThePath) {
  DynamicWindow planner = planner_to(8.0);
  EXPECT_NEAR(planner.decide(wall_at(1.5), {}, {}, {}, 0.05).obstacle_distance, 1.5 - 0.305, 0.08);
  EXPECT_EQ(planner.decide(empty_window(), {}, {}, {}, 0.05).obstacle_distance, kInfinity);
}

TEST(Decide, SaysBlockedBeforeAWallAndStands) {
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(wall_at(0.45), {}, {}, {}, 0.05);
  EXPECT_TRUE(decision.blocked);
  EXPECT_EQ(decision.reason, Reason::kBlocked);
  EXPECT_EQ(decision.command, (Twist2{0, 0}));
}

TEST(Decide, BrakesHarderThanItSlowsWhenAnObstacleAppears) {
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(wall_at(0.6), {}, {1.0, 0.2}, {1.0, 0.2}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_NEAR(decision.command.v, 0.9, 1e-12);
  EXPECT_NEAR(decision.command.w, 0.18, 0.1);  // about along the arc that it is on
}

/// It rolls for most of a metre, and straight on is another way than the arc that was free.
TEST(Decide, SteersOnWhileItRollsThoughItIsToldToStand) {
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(wall_at(0.6), {}, {0.6, 0.4}, {0.0, 0.4}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_EQ(decision.command.v, 0.0);
  EXPECT_GT(decision.command.w, 0.2);
}

TEST(Decide, StandsWhenACellLiesInsideTheOutline) {
  DynamicWindow planner = planner_to(8.0);
  Costs costs = empty_window();
  costs.at(costs.geometry().cell_at(0.2, 0.1)) = grid::kLethalCost;
  const Decision decision = planner.decide(costs, {}, {}, {}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kTouching);
  EXPECT_TRUE(decision.blocked);
}

TEST(Decide, TreatsUnknownAsAsked) {
  Costs costs = empty_window();
  for (std::uint8_t& c : costs) c = grid::kUnknownCost;
  DynamicWindow open = planner_to(8.0);
  EXPECT_EQ(open.decide(costs, {}, {}, {}, 0.05).reason, Reason::kFollowing);
  DynamicWindowConfig config;
  config.unknown_is_lethal = true;
  DynamicWindow closed = planner_to(8.0, config);
  EXPECT_TRUE(closed.decide(costs, {}, {}, {}, 0.05).blocked);
}

TEST(Decide, TurnsInPlaceBeforeAPathThatStartsBehind) {
  DynamicWindow planner = planner_to(-5.0);
  const Decision decision = planner.decide(empty_window(), {0, 0, 0.3}, {}, {}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kTurning);
  EXPECT_EQ(decision.command.v, 0.0);
  EXPECT_GT(decision.command.w, 0.0);  // the shorter way round
}

TEST(Decide, TurnsTheOtherWayRoundWhenTheShorterIsClosed) {
  // A post beside the long nose of a robot: it cannot turn left, but right.
  DynamicWindowConfig config;
  const std::vector<Point2> nose{{0.7, -0.2}, {0.7, 0.2}, {-0.2, 0.2}, {-0.2, -0.2}};
  config.footprint = Footprint::make(nose).value();
  DynamicWindow planner = planner_to(-5.0, config);
  Costs costs = empty_window();
  costs.at(costs.geometry().cell_at(0.45, 0.4)) = grid::kLethalCost;
  const Decision decision = planner.decide(costs, {0, 0, 0.05}, {}, {}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kTurning);
  EXPECT_LT(decision.command.w, 0.0);
}

TEST(Decide, ReportsTheGoalOnlyStanding) {
  DynamicWindow planner = planner_to(0.05);
  EXPECT_TRUE(planner.decide(empty_window(), {0.05, 0, 0}, {}, {}, 0.05).reached);
  EXPECT_FALSE(planner.decide(empty_window(), {0.05, 0, 0}, {0.3, 0}, {0.3, 0}, 0.05).reached);
}

TEST(Decide, KeepsTheReachedPositionWhenThePathIsSentAgain) {
  DynamicWindow planner = planner_to(2.0);
  EXPECT_TRUE(planner.decide(empty_window(), {1.95, 0, 0}, {}, {}, 0.05).reached);
  ASSERT_TRUE(planner.set_path(std::vector<Pose2>{{1.9, 0, 0}, {2.05, 0.02, 0}}).ok());
  EXPECT_TRUE(planner.decide(empty_window(), {1.93, 0, 0}, {}, {}, 0.05).reached);
  ASSERT_TRUE(planner.set_path(std::vector<Pose2>{{1.9, 0, 0}, {2.5, 0, 0}}).ok());
  EXPECT_FALSE(planner.decide(empty_window(), {1.93, 0, 0}, {}, {}, 0.05).reached);
}

TEST(Decide, YieldsToSomebodyWhoComesTowardsIt) {
  DynamicWindow planner = planner_to(8.0);
  const std::vector<MovingDisc> person{{{2.5, 0}, {-1.0, 0}, 0.3}};
  const Decision free = planner.decide(empty_window(), {}, {1.0, 0}, {1.0, 0}, 0.05);
  const Decision met = planner.decide(empty_window(), {}, {1.0, 0}, {1.0, 0}, 0.05, person);
  EXPECT_LT(met.admissible, free.admissible);
  EXPECT_TRUE(met.target.v < 0.6 || std::abs(met.target.w) > 0.2);
}

TEST(Decide, ForeseesWhoWalksAndIsNotBehind) {
  DynamicWindow planner = planner_to(8.0);
  const auto admissible = [&](const std::vector<MovingDisc>& people) {
    return planner.decide(empty_window(), {}, {1.0, 0}, {1.0, 0}, 0.05, people).admissible;
  };
  const int alone = admissible({});
  EXPECT_LT(admissible({{{2.0, 1.0}, {-0.5, -0.5}, 0.25}}), alone);
  EXPECT_EQ(admissible({{{2.0, 1.0}, {-0.2, -0.2}, 0.25}}), alone) << "the costs say where";
  EXPECT_EQ(admissible({{{-0.5, 1.0}, {1.0, -0.5}, 0.25}}), alone) << "they see the robot";
}

TEST(Decide, CreepsPastWhoStandsWithinArmsLength) {
  DynamicWindow planner = planner_to(8.0);
  const auto speed = [&](const geometry::Point2& where) {
    const std::vector<MovingDisc> person{{where, {0.0, 0.0}, 0.25}};
    const Decision decision = planner.decide(empty_window(), {}, {0.5, 0}, {0.5, 0}, 0.05, person);
    EXPECT_EQ(decision.reason, Reason::kFollowing);
    return decision.target.v;
  };
  EXPECT_LE(speed({0.4, -0.7}), DynamicWindowConfig{}.careful_speed);
  EXPECT_LE(speed({0.0, 0.7}), DynamicWindowConfig{}.careful_speed);
  EXPECT_GT(speed({-0.6, 0.3}), 0.5) << "behind";
  EXPECT_GT(speed({0.4, -1.2}), 0.5) << "out of reach";
}

TEST(Decide, IsNoFasterThanItCanStopBeforeWhoIsAheadThoughItsWayLeadsPastThem) {
  DynamicWindowConfig config;
  config.pace = 0.9;
  DynamicWindow planner = planner_to(8.0, config);
  const auto speed = [&](const geometry::Point2& where) {
    const std::vector<MovingDisc> person{{where, {0.0, 0.0}, 0.25}};
    return planner.decide(empty_window(), {}, {0.5, 0}, {0.5, 0}, 0.05, person).target.v;
  };
  const double gap = std::hypot(1.1, 0.8) - config.footprint.inscribed_radius() - 0.25;
  EXPECT_LE(speed({1.1, 0.8}), std::max(config.careful_speed, config.stopping.speed(gap)) + 1e-9);
  EXPECT_GT(speed({0.5, 1.3}), config.stopping.speed(gap)) << "beside";
}

/// The laser, blind so near, shows nothing of them.
TEST(Decide, DoesNotTurnIntoSomebodyWhoStandsAtItsSideAndGoesStraightOn) {
  const DynamicWindowConfig config;
  const MovingDisc person{{0.2, config.footprint.inscribed_radius() + 0.27}, {0, 0}, 0.25};
  const Costs costs = empty_window();
  const auto drive = [&](const std::vector<Pose2>& path) {
    DynamicWindow planner = DynamicWindow::make(config).value();
    EXPECT_TRUE(planner.set_path(path));
    Pose2 pose;
    Twist2 command;
    double least = kInfinity;
    for (int i = 0; i < 200; ++i) {
      command = planner.decide(costs, pose, command, command, 0.05, {{person}}).command;
      pose = geometry::integrate(pose, command, 0.05);
      least = std::min(least, config.footprint.distance(inverse(pose) * person.position));
    }
    EXPECT_GE(least, person.radius - 0.02);
    return pose.x;
  };
  EXPECT_LT(drive({{0, 0, 0}, {0.4, 0.1, 0.6}, {1.0, 1.2, 1.2}}), 0.1) << "the way is through them";
  EXPECT_GT(drive({{0, 0, 0}, {3.0, 0, 0}}), 0.5);
}

/// Between walls that leave 0.65 m; where the left one ends the costs know of somebody too little.
TEST(Decide, SqueezesPastAPostButPastNobody) {
  const double side = DynamicWindowConfig{}.footprint.inscribed_radius();
  const MovingDisc person{{1.2, side + 0.29}, {0, 0}, 0.25};
  World world(-3, -3.02, 3, 2.98);
  world.add(Box{-3, -3, 3, -0.33});
  world.add(Box{-3, 0.34, 0.9, 3});
  world.add(Disc{person.position.x(), person.position.y(), 0.22});
  world.finish(side);
  const auto decide = [&](std::span<const MovingDisc> people) {
    DynamicWindow planner = planner_to(2.5);
    return planner.decide(world.costs(), {0.45, 0, 0}, {}, {}, 0.05, people);
  };
  const Decision past_a_post = decide({});
  EXPECT_EQ(past_a_post.reason, Reason::kTight);
  EXPECT_GT(past_a_post.target.v, 0.0);
  EXPECT_EQ(decide({{person}}).reason, Reason::kBlocked);
  EXPECT_EQ(decide({{{{1.2, side + 0.36}, {0, 0}, 0.25}}}).reason, Reason::kTight) << "0.11 m";
}

TEST(Decide, StandsBeforeWhomItMeetsAndGoesOnWhenNobodyPasses) {
  DynamicWindow planner = planner_to(8.0);
  const auto reason = [&](const std::vector<MovingDisc>& people) {
    return planner.decide(empty_window(), {}, {}, {}, 0.05, people).reason;
  };
  const std::vector<MovingDisc> met{{{1.3, 0.1}, {-0.2, 0}, 0.25}};
  const std::vector<MovingDisc> elsewhere[] = {{},
                                               {{{2.5, 0}, {-0.5, 0}, 0.25}},
                                               {{{1.0, 0.9}, {-0.5, 0}, 0.25}},
                                               {{{1.0, 0}, {0.6, 0}, 0.25}},
                                               {{{1.1, 0.3}, {0.1, 0.7}, 0.25}},
                                               {{{-0.6, 0}, {0, 0}, 0.25}}};
  for (const auto& people : elsewhere) EXPECT_EQ(reason(people), Reason::kFollowing);
  EXPECT_EQ(reason(met), Reason::kGivingWay);
  for (int cycle = 0; cycle < 100; ++cycle) ASSERT_EQ(reason(met), Reason::kGivingWay) << cycle;
  for (int cycle = 0; cycle < 30; ++cycle) reason(met);
  EXPECT_EQ(reason(met), Reason::kFollowing) << "for ever it does not wait";
  for (int cycle = 0; cycle < 70; ++cycle) reason({});
  EXPECT_EQ(reason(met), Reason::kGivingWay) << "somebody else";
}

TEST(Decide, BrakesStraightBeforeSomebodyInsteadOfIntoTheWall) {
  World world(-3, -3, 3, 3);
  world.add(Box{-3, 0.6, 3, 0.7});
  world.add(Box{-3, -0.7, 3, -0.6});
  world.finish(0.305);
  DynamicWindow planner = planner_to(8.0);
  const std::vector<MovingDisc> person{{{1.6, 0}, {-0.8, 0}, 0.25}};
  const Decision decision = planner.decide(world.costs(), {}, {0.9, 0}, {0.9, 0}, 0.05, person);
  EXPECT_LT(decision.command.v, 0.9);
  EXPECT_LT(std::abs(decision.command.w), 0.1);
}

TEST(Decide, BrakesOnItsArcBetweenThePostsOfADoor) {
  World world(-3, -3, 3, 3);
  world.add(Box{-0.2, 0.35, 0.0, 3});
  world.add(Box{-0.2, -3, 0.0, -0.35});
  world.add(Box{0.8, -3, 0.9, 0.0});
  world.finish(0.305);
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(world.costs(), {}, {0.5, 0}, {0.5, 0}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_NEAR(decision.command.w, 0.0, 1e-9) << "past the half wall the outline alone would fit";
}

TEST(Decide, BrakesPastAPostThatATurnLeavesFree) {
  World world(-3, -3, 3, 3);
  world.add(Box{0.9, -3, 1.0, -0.26});
  world.add(Box{0.9, 0.45, 1.0, 3});
  world.finish(0.305);
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(world.costs(), {}, {0.9, 0}, {0.9, 0}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_GT(decision.command.w, 0.05) << "away from it";
}

TEST(Decide, BrakesPastAPostThatOnlyAHardTurnLeavesFree) {
  // It turns toward the post, and what the dynamic window reaches no longer leads past it.
  World world(-3, -3, 3, 3);
  world.add(Box{0.6, -3, 0.7, -0.4});
  world.finish(0.305);
  DynamicWindow planner = planner_to(8.0);
  const Decision decision = planner.decide(world.costs(), {}, {0.61, -0.56}, {0.88, -0.8}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_NEAR(decision.command.w, -0.7, 1e-9) << "away from it as fast as it may";
}

// An echo from the edge of a pane bars the whole opening beside it (window 1364).
TEST(Decide, BrakesOnItsArcWhereNoneIsFreeAndNoneLeadsMuchFarther) {
  const auto turn_of = [](double beside) {
    World world(-3, -3, 3, 3);
    world.add(Box{1.1, 0.3, 1.15, 3});
    world.add(Box{beside, -3, beside + 0.05, 0.3});
    world.finish(0.305);
    DynamicWindow planner = planner_to(8.0);
    const Twist2 rolls{0.9, 0.3};
    const Decision decision = planner.decide(world.costs(), {}, rolls, rolls, 0.05);
    EXPECT_EQ(decision.reason, Reason::kBraking);
    return decision.command.w;
  };
  EXPECT_NEAR(turn_of(1.3), 0.3, 0.05);
  EXPECT_NEAR(turn_of(1.6), 0.2, 1e-9) << "there it has more time: as fast as it may";
}

TEST(Decide, BrakesThroughAGapThatOnlyTheCentersOfCellsLeaveFree) {
  // Bending right, toward the wall beside it.
  World world(-3, -3, 3, 3);
  world.add(Box{0.85, -3, 0.9, -0.3});
  world.add(Box{0.6, 0.32, 0.9, 3});
  world.finish(0.305);
  DynamicWindow planner = planner_to(8.0);
  const Twist2 rolls{0.8, -0.2};
  const Decision decision = planner.decide(world.costs(), {}, rolls, rolls, 0.05);
  EXPECT_EQ(decision.reason, Reason::kBraking);
  EXPECT_NEAR(decision.command.w, -0.1, 1e-9) << "away from the wall as fast as it may";
}

TEST(Decide, DodgesAPostAndNobodyWhenItBrakesBetweenWalls) {
  // In a corridor of 1.3 m, too near to stop before it. People step aside, and the wall is certain.
  World world(-3, -3, 3, 3);
  world.add(Box{-3, 0.65, 3, 0.75});
  world.add(Box{-3, -0.75, 3, -0.65});
  world.add(Disc{1.2, -0.4, 0.25});
  world.finish(0.305);
  const auto braked = [&](std::span<const MovingDisc> people) {
    DynamicWindow planner = planner_to(8.0);
    const Decision decision = planner.decide(world.costs(), {}, {0.9, 0}, {0.9, 0}, 0.05, people);
    EXPECT_EQ(decision.reason, Reason::kBraking);
    return decision.command.w;
  };
  EXPECT_GT(braked({}), 0.05);
  const std::vector<MovingDisc> somebody{{{1.2, -0.4}, {0.0, 0.5}, 0.25}};
  EXPECT_EQ(braked(somebody), 0.0);
  const std::vector<MovingDisc> nowhere{{{1e300, -1e300}, {0.0, 0.0}, 0.25}};
  EXPECT_GT(braked(nowhere), 0.05);
}

TEST(Decide, AskewBeforeADoorTurnsAsFarAsThePostsLetIt) {
  World world(-3, -3, 3, 3);
  world.add(Box{0.1, 0.38, 0.2, 3});
  world.add(Box{0.1, -3, 0.2, -0.38});
  world.add(Box{-3, 0.5, 0.1, 0.6});
  world.finish(0.305);
  DynamicWindowConfig config;
  config.footprint = marvin();
  DynamicWindow planner = planner_to(8.0, config);
  const Decision decision = planner.decide(world.costs(), {-0.2, -0.065, 0.54}, {}, {}, 0.05);
  EXPECT_EQ(decision.reason, Reason::kTurning) << "straight it does not fit there";
  EXPECT_EQ(decision.target, (Twist2{0.0, -config.tight_turn}));
}

TEST(Decide, InATightPlaceTurnsNoFasterThanItRollsOnItsArc) {
  World world(-3, -3.02, 3, 2.98);
  world.add(Box{-3, -3, 3.0, -0.40});
  world.add(Box{-3, 0.40, 0.9, 3});
  world.finish(0.305);
  DynamicWindowConfig config;
  config.tight_turn = 0.05;
  const auto turn = [&](double rolls) {
    DynamicWindow planner = planner_to(2.5, config);
    const Twist2 told{std::max(rolls, 0.0), 0.0};
    const Decision decision =
        planner.decide(world.costs(), {0.45, 0, -0.12}, {rolls, 0.0}, told, 0.05);
    EXPECT_EQ(decision.reason, Reason::kTight);
    EXPECT_GT(decision.target.w, 0.1) << "askew, it turns straight";
    return decision.command.w;
  };
  EXPECT_GT(turn(0.2), 1.4 * config.tight_turn);
  EXPECT_DOUBLE_EQ(turn(0.0), config.tight_turn) << "it leans before it rolls";
  EXPECT_DOUBLE_EQ(turn(-0.02), config.tight_turn);
}

TEST(Rotating, CreepsTheSlowerTheMoreTheBaseSways) {
  Costs costs = empty_window();
  costs.at(costs.geometry().cell_at(0.34, 0.34)) = grid::kLethalCost;
  const auto rate = [&](double sways) {
    DynamicWindow planner = DynamicWindow::make({}).value();
    EXPECT_TRUE(planner.set_path(std::vector<Pose2>{{0, 0, 0}, {-2, 0, 0}}).ok());
    const Decision decision = planner.decide(costs, {0, 0, 0}, {sways, 0.0}, {}, 0.05);
    EXPECT_EQ(decision.reason, Reason::kTurning);
    return std::abs(decision.target.w);
  };
  const DynamicWindowConfig config;
  const double corner = config.footprint.circumscribed_radius();
  EXPECT_DOUBLE_EQ(rate(0.0), config.tight_turn);
  for (const double sways : {-0.04, 0.03, 0.05})
    EXPECT_LT(rate(sways) * corner + std::abs(sways), config.tight_turn * corner + 0.021);
  EXPECT_GT(rate(0.14), 0.0) << "else it would never get out";
}

TEST(Decide, GivesUpATurnThatWhiskersBarInBothSenses) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  ASSERT_TRUE(planner.set_path(std::vector<Pose2>{{0, 0, 0}, {-2, 0, 0}}).ok());
  Decision decision;
  double yaw = 0.0;
  int turns = 0;
  for (int i = 0; i < 2000 && decision.command.v == 0.0; ++i) {
    planner.set_touches({yaw > 0.6, yaw < -0.6, yaw<-0.6, yaw> 0.6});
    const double before = decision.command.w;
    decision = planner.decide(empty_window(), {0, 0, yaw}, {}, decision.command, 0.05);
    yaw += 0.05 * decision.command.w;
    turns += before * decision.command.w < 0.0;
  }
  EXPECT_GE(turns, 2) << "both senses are tried";
  EXPECT_LE(turns, 5) << "and not for ever";
  EXPECT_GT(decision.command.v, 0.0) << "perhaps an arc leads out";
}

TEST(Decide, IsTheSameOnEveryInstructionSet) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    World world(-3, -3, 3, 3);
    for (int k = 0; k < 8; ++k) {
      const Disc disc{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(0.05, 0.3)};
      if (std::hypot(disc.x, disc.y) > 0.5 + disc.radius) world.add(disc);
    }
    world.finish(0.305);
    const std::vector<Pose2> path{{0, 0, 0}, {random.uniform(1, 4), random.uniform(-3, 3), 0}};
    DynamicWindow portable = DynamicWindow::make({}, cpu::Simd::kPortable).value();
    DynamicWindow best = DynamicWindow::make({}).value();
    ASSERT_TRUE(portable.set_path(path).ok() && best.set_path(path).ok());
    const Twist2 measured{random.uniform(0, 1), random.uniform(-0.5, 0.5)};
    const Decision a = portable.decide(world.costs(), {0, 0, 0.2}, measured, measured, 0.05);
    const Decision b = best.decide(world.costs(), {0, 0, 0.2}, measured, measured, 0.05);
    ASSERT_EQ(a.command, b.command);
    ASSERT_EQ(a.target, b.target);
    ASSERT_EQ(a.admissible, b.admissible);
    ASSERT_EQ(a.scores.total(), b.scores.total());
    ASSERT_EQ(a.obstacle_distance, b.obstacle_distance);
  }
}

TEST(Decide, RolloutSamplesMoreThanTheWindow) {
  DynamicWindowConfig config;
  config.sampling = Sampling::kTrajectoryRollout;
  DynamicWindow planner = planner_to(8.0, config);
  EXPECT_GT(planner.decide(empty_window(), {}, {}, {}, 0.05).target.v, 1.0);
  DynamicWindow window = planner_to(8.0);
  EXPECT_LT(window.decide(empty_window(), {}, {}, {}, 0.05).target.v, 0.5);
}

TEST(BackingOff, RunsStraightBackWhileThereIsRoom) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  const Decision decision = planner.back_off(empty_window(), {}, {}, {}, 0.05, 0.15);
  EXPECT_EQ(decision.reason, Reason::kRecovering);
  EXPECT_LT(decision.command.v, 0.0);
  EXPECT_EQ(decision.command.w, 0.0);
}

// Range finders are blind at the robot, and recoveries begin where somebody stands.
TEST(Recovery, MeetsNobodyWhoStandsAtTheRobot) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  const auto blocked = [&](const geometry::Point2& place) {
    const std::vector<MovingDisc> somebody{{place, {0.0, 0.0}, 0.25}};
    return std::pair(planner.back_off(empty_window(), {}, {}, {}, 0.05, 0.15, somebody).blocked,
                     planner.rotate(empty_window(), {}, {}, {}, 0.05, 0.4, somebody).blocked);
  };
  EXPECT_EQ(blocked({-0.65, 0.0}), std::pair(true, true));
  EXPECT_EQ(blocked({0.65, 0.0}), std::pair(false, true));
  EXPECT_EQ(blocked({1.5, 0.0}), std::pair(false, false));
}

TEST(Turning, TakesATouchedCornerOutOfTheWayFirst) {
  // The path leads to the left of a robot that stands.
  const std::vector<geometry::Pose2> path = {{0.0, 0.0, 1.57}, {0.0, 2.0, 1.57}};
  struct Row {
    Whiskers touches;
    int v, w;  ///< signs of the command
  };
  const Row rows[] = {
      {{}, 0, 1},
      {{.back_right = true}, 1, 0},                       // the tail would swing into it
      {{.front_left = true}, -1, 0},                      // the nose would
      {{.front_right = true}, 0, 1},                      // turns away from it
      {{.front_left = true, .back_right = true}, 0, -1},  // the long way round
  };
  for (const Row& row : rows) {
    DynamicWindow planner = DynamicWindow::make({}).value();
    ASSERT_TRUE(planner.set_path(path).ok());
    planner.set_touches(row.touches);
    const Decision decision = planner.decide(empty_window(), {}, {}, {}, 0.05);
    EXPECT_EQ(sign(decision.target.v), row.v);
    EXPECT_EQ(sign(decision.target.w), row.w);
  }
}

/// Turned by 1.05 rad between walls so far to its left and right, the path behind it, the corners
/// that these touch touched; `marks` of touches at the front left whisker.
Decision turns_between_walls(double left, double right, int marks = 0) {
  DynamicWindowConfig config;
  config.footprint = marvin();
  config.tight_speed = 0.1;
  DynamicWindow planner = DynamicWindow::make(config).value();
  EXPECT_TRUE(planner.set_path(std::vector<Pose2>{{0, 0, 3.1}, {-2, 0, 3.1}}).ok());
  planner.set_touches({.front_left = true, .back_right = true});
  World world(-3, -3, 3, 3);
  world.add(Box{-3, left, 3, left + 0.1});
  world.add(Box{-3, -right - 0.1, 3, -right});
  world.finish(0.305);
  Costs costs = world.costs();
  const Pose2 pose{0, 0, 1.05};
  for (int i = 0; i < marks; ++i) {
    const Point2 mark = pose * Point2(0.305 + 0.1 + 0.2 * i, 0.33);
    costs.at(costs.geometry().cell_at(mark)) = grid::kLethalCost;
  }
  return planner.decide(costs, pose, {}, {}, 0.05);
}

TEST(Turning, GoesOnCreepingBesideWallsThatItKnowsAndTouches) {
  const double creeping = 0.05 / marvin().circumscribed_radius();
  const Decision turns = turns_between_walls(0.7, 0.7);
  EXPECT_EQ(turns.reason, Reason::kTurning);
  EXPECT_EQ(turns.target.v, 0.0);
  EXPECT_NEAR(turns.target.w, creeping, 1e-9);
  EXPECT_LE(turns_between_walls(2.0, 0.7).target.w, 0.0) << "what is at the front left corner?";
  EXPECT_LE(turns_between_walls(2.0, 0.7, 2).target.w, 0.0) << "its own marks explain no touch";
  EXPECT_LE(turns_between_walls(0.7, 2.0).target.w, 0.0) << "and at the back right one?";
  EXPECT_LE(turns_between_walls(0.47, 0.7).target.w, 0.0) << "half of the clearance is kept";
}

TEST(Turning, GivesUpToAndFroBetweenTwoTouchedCorners) {
  const std::vector<geometry::Pose2> path = {{0.0, 0.0, 1.57}, {0.0, 2.0, 1.57}};
  DynamicWindow planner = DynamicWindow::make({}).value();
  ASSERT_TRUE(planner.set_path(path).ok());
  int moves = 0;
  const auto frees = [&](bool in_front) {
    planner.set_touches(in_front ? Whiskers{.front_left = true} : Whiskers{.back_right = true});
    return planner.decide(empty_window(), {}, {}, {}, 0.05).reason == Reason::kRecovering;
  };
  while (moves < 20 && frees(moves % 2 == 0)) ++moves;
  EXPECT_EQ(moves, 4);
  EXPECT_FALSE(frees(true)) << "and stays so";
  planner.set_touches({});
  EXPECT_FALSE(planner.back_off(empty_window(), {}, {}, {}, 0.05, 0.15).blocked);
  EXPECT_TRUE(frees(true)) << "after a recovery it may try again";
}

TEST(BackingOff, FollowsTheWayThatItCame) {
  // It drove a bend to the left; back along it, its tail swings to the right and its yaw falls.
  DynamicWindow planner = planner_to(3.0);
  geometry::Pose2 pose;
  std::vector<geometry::Pose2> way;
  for (int i = 0; i < 60; ++i) {
    planner.decide(empty_window(), pose, {}, {}, 0.05);
    way.push_back(pose);
    pose = geometry::integrate(pose, {0.4, 0.3}, 0.05);
  }
  geometry::Twist2 command;
  for (int i = 0; i < 100; ++i) {
    const Decision decision = planner.back_off(empty_window(), pose, command, command, 0.05, 0.15);
    ASSERT_EQ(decision.reason, Reason::kRecovering);
    command = decision.command;
    pose = geometry::integrate(pose, command, 0.05);
    double off = 1.0;
    for (const auto& then : way) off = std::min(off, geometry::distance(then, pose));
    ASSERT_LT(off, 0.05) << i;
  }
  EXPECT_NEAR(pose.yaw, 60 * 0.05 * 0.3 - 0.75 * 0.73, 0.15);
}

TEST(BackingOff, TurnsItsTailAwayFromWhatItTouches) {
  struct Row {
    Whiskers touches;
    int v, w;  ///< signs of the command
    bool blocked = false;
  };
  const Row rows[] = {
      {{.back_right = true}, 0, -1},
      {{.back_left = true}, 0, 1},
      {{.front_right = true, .back_left = true}, 0, 1},    // across a door
      {{.front_right = true, .back_right = true}, -1, 0},  // a wall beside it
      {{.front_left = true, .front_right = true, .back_right = true}, -1, 0},
      {{.front_left = true, .back_left = true, .back_right = true}, 0, 0, true},
  };
  for (const Row& row : rows) {
    DynamicWindow planner = DynamicWindow::make({}).value();
    planner.set_touches(row.touches);
    const Decision decision = planner.back_off(empty_window(), {}, {}, {}, 0.05, 0.15);
    EXPECT_EQ(decision.blocked, row.blocked);
    EXPECT_EQ(sign(decision.target.v), row.v);
    EXPECT_EQ(sign(decision.target.w), row.w);
  }
}

TEST(BackingOff, LooksAtTheWayThatTheWhiskersLeave) {
  // It came on a bend to the left and would go back on it, past what stands straight behind; with a
  // wall felt along its right the reflex lets it bend no more.
  DynamicWindowConfig config;
  config.footprint = marvin();
  DynamicWindow planner = planner_to(8.0, config);
  Pose2 pose{-2.0, 0.0, -1.0};
  for (int i = 0; i < 40; ++i) {
    planner.decide(empty_window(), pose, {0.5, 0.5}, {0.5, 0.5}, 0.05);
    pose = geometry::integrate(pose, {0.5, 0.5}, 0.05);
  }
  const Point2 behind = pose * Point2(-0.55, -0.28);
  Costs costs = empty_window();
  costs.at(costs.geometry().cell_at(behind.x(), behind.y())) = grid::kLethalCost;
  const Decision bends = planner.back_off(costs, pose, {}, {}, 0.05, 0.15);
  EXPECT_FALSE(bends.blocked);
  EXPECT_LT(bends.target.w, -0.05);
  planner.set_touches({.front_right = true, .back_right = true});
  EXPECT_TRUE(planner.back_off(costs, pose, {}, {}, 0.05, 0.15).blocked);
}

TEST(BackingOff, StopsBeforeAWallBehind) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  EXPECT_TRUE(planner.back_off(wall_at(-0.5), {}, {}, {}, 0.05, 0.15).blocked);
  EXPECT_FALSE(planner.back_off(wall_at(-0.9), {}, {}, {}, 0.05, 0.15).blocked);
}

TEST(BackingOff, LeavesWhatTouchesInFront) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  EXPECT_FALSE(planner.back_off(wall_at(0.25), {}, {}, {}, 0.05, 0.15).blocked);
}

// A balancing base sways by more than a whisker's length.
TEST(BackingOff, WhoHasToWaitSparesWhatTouchesInFront) {
  const Costs wall = wall_at(0.305 + 0.06);
  const auto command = [&](DynamicWindow& planner, const Pose2& pose, const Whiskers& touches) {
    planner.set_touches(touches);
    const Decision decision = planner.decide(wall, pose, {}, {}, 0.1);
    EXPECT_TRUE(decision.blocked);
    EXPECT_EQ(decision.command.w, 0.0);
    return decision.command.v;
  };
  const Whiskers front{.front_left = true}, both{.front_left = true, .back_right = true};
  DynamicWindow planner = planner_to(2.0);
  EXPECT_EQ(command(planner, {}, {}), 0.0);
  EXPECT_EQ(command(planner, {}, both), 0.0) << "something behind, too";
  EXPECT_LT(command(planner, {}, front), 0.0);
  EXPECT_LT(command(planner, {-0.1, 0, 0}, front), 0.0);
  EXPECT_EQ(command(planner, {-0.13, 0, 0}, front), 0.0) << "far enough: it is no wall";
  Costs narrow = wall;
  const grid::GridGeometry& g = narrow.geometry();
  for (int y = 0; y < g.height; ++y) narrow.at({g.cell_at({-0.4, 0.0}).x, y}) = 254;
  DynamicWindow between = planner_to(2.0);
  between.set_touches(front);
  EXPECT_EQ(between.decide(narrow, {}, {}, {}, 0.1).command.v, 0.0) << "a wall behind";
  Costs touched = wall;
  for (int y = 0; y < g.height; ++y) touched.at({g.cell_at({-0.28, 0.0}).x, y}) = 254;
  DynamicWindow tight = planner_to(2.0);
  tight.set_touches(front);
  EXPECT_EQ(tight.decide(touched, {}, {}, {}, 0.1).command.v, 0.0) << "one that it nearly touches";
}

TEST(Rotating, RunsWhileTheOutlineSweepsNothing) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  EXPECT_GT(planner.rotate(empty_window(), {}, {}, {}, 0.05, 0.4).command.w, 0.0);
  EXPECT_LT(planner.rotate(empty_window(), {}, {}, {}, 0.05, -0.4).command.w, 0.0);
  Costs costs = empty_window();
  costs.at(costs.geometry().cell_at(0.38, 0.0)) =
      grid::kLethalCost;  // before the middle of the front, inside the corners' circle
  EXPECT_TRUE(planner.rotate(costs, {0, 0, 0.55}, {}, {}, 0.05, -1.0).blocked ||
              planner.rotate(costs, {0, 0, 0.55}, {}, {}, 0.05, 1.0).blocked);
}

TEST(Rotating, RefusesARateThatIsNotFinite) {
  DynamicWindow planner = DynamicWindow::make({}).value();
  const Decision decision = planner.rotate(empty_window(), {}, {}, {}, 0.05, kNaN);
  EXPECT_EQ(decision.reason, Reason::kInvalidInput);
  EXPECT_EQ(decision.command, (Twist2{0, 0}));
}

}  // namespace
}  // namespace usher::local_planner
