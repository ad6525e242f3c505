#include "control/movement_control/core/movement_control.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "control/movement_control/test/inputs.hpp"

namespace usher::movement_control {
namespace {

using geometry::Twist2;
using std::chrono::milliseconds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The command that is reached when the inputs stay as they are for five seconds.
Decision settled(const Inputs& inputs, const Parameters& parameters = {}) {
  MovementControl control(parameters);
  Decision decision;
  for (int i = 0; i < 250; ++i) decision = control.decide(inputs, milliseconds(20 * i));
  return decision;
}

struct Case {
  const char* name;
  void (*change)(Inputs&);
  Twist2 twist;
  Source source;
  Limit limit;
};

TEST(MovementControl, KeepsTheArcWhileTheBaseIsFasterThanItMayBe) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = Twist2{0.6, 0.4};
  inputs.measured = inputs.navigation;
  Time now{};
  const auto decide = [&] {
    Decision decision;
    for (int i = 0; i < 50; ++i) decision = control.decide(inputs, now += milliseconds(20));
    return decision.twist;
  };
  EXPECT_EQ(decide(), (Twist2{0.6, 0.4}));
  inputs.enables->speed_factor = 0.25;  // 0.35 m/s and 0.25 rad/s in open space
  inputs.navigation = Twist2{0.7, 0.2};
  inputs.measured = Twist2{0.7, 0.2};
  EXPECT_NEAR(decide().v, 0.35, 1e-9);
  EXPECT_NEAR(decide().w, 0.2, 1e-9) << "it rolls on";
  inputs.measured = Twist2{0.35, 0.2};
  EXPECT_NEAR(decide().w, 0.1, 1e-9) << "now it is as slow as it may be";
  inputs.navigation = Twist2{0.7, 0.4};
  inputs.measured = Twist2{0.7, 0.2};
  EXPECT_NEAR(decide().w, 0.25, 1e-9) << "no limit of the turn rate is passed";
  inputs.enables->speed_factor = 1.0;
  inputs.navigation = inputs.measured = Twist2{0.7, 0.2};
  decide();
  inputs.enables->speed_factor = 0.25;
  inputs.measured = Twist2{0.1, 0.0};  // odometers that hang
  EXPECT_NEAR(control.decide(inputs, now += milliseconds(20)).twist.w, 0.2, 1e-9);
}

TEST(MovementControl, DecidesByTheTable) {
  using enum Limit;
  const Case cases[] = {
      {"silence is zero", [](Inputs&) {}, {}, Source::kNone, kNoCommand},
      {"navigation drives alone",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2};
       },
       {0.5, 0.2},
       Source::kNavigation,
       kNone},
      {"interaction goes before navigation",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.interaction = {0.0, -0.3};
       },
       {0.0, -0.3},
       Source::kInteraction,
       kNone},
      {"manual goes before all",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.interaction = {0.0, -0.3}, i.manual = {0.1, 0.0};
       },
       {0.1, 0.0},
       Source::kManual,
       kNone},
      {"a zero of manual is a command",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.manual = {0.0, 0.0};
       },
       {0.0, 0.0},
       Source::kManual,
       kNone},
      {"a disabled source is passed over",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.manual = {0.1, 0.0}, i.enables->manual = false;
       },
       {0.5, 0.2},
       Source::kNavigation,
       kNone},
      {"no source enabled",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.enables = Enables{true};
       },
       {},
       Source::kNone,
       kNotEnabled},
      {"movement disabled",
       [](Inputs& i) {
         i.manual = {0.5, 0.2}, i.enables->movement = false;
       },
       {},
       Source::kNone,
       kNotEnabled},
      {"supervisor silent",
       [](Inputs& i) {
         i.manual = {0.5, 0.2}, i.enables.reset();
       },
       {},
       Source::kNone,
       kNotEnabled},
      {"base silent",
       [](Inputs& i) {
         i.manual = {0.5, 0.2}, i.measured.reset();
       },
       {},
       Source::kNone,
       kNoBase},
      {"whiskers silent",
       [](Inputs& i) {
         i.manual = {0.5, 0.2}, i.whiskers.reset();
       },
       {},
       Source::kNone,
       kNoWhiskers},
      {"nonsense of a higher source lets no lower one drive",
       [](Inputs& i) {
         i.navigation = {0.5, 0.2}, i.manual = {kNan, 0.0};
       },
       {},
       Source::kManual,
       kNotFinite},

      {"open space",
       [](Inputs& i) {
         i.navigation = {2.0, 0.0};
       },
       {1.4, 0.0},
       Source::kNavigation,
       kSituation},
      {"corridor",
       [](Inputs& i) {
         i.navigation = {2.0, 0.0}, i.situation = Situation::kCorridor;
       },
       {1.0, 0.0},
       Source::kNavigation,
       kSituation},
      {"confined",
       [](Inputs& i) {
         i.navigation = {2.0, 0.0}, i.situation = Situation::kConfined;
       },
       {0.8, 0.0},
       Source::kNavigation,
       kSituation},
      {"a slower robot drives the same arc",
       [](Inputs& i) {
         i.navigation = {2.8, 0.5};
       },
       {1.4, 0.25},
       Source::kNavigation,
       kSituation},
      {"turning is limited too",
       [](Inputs& i) {
         i.navigation = {1.0, -2.0};
       },
       {0.5, -1.0},
       Source::kNavigation,
       kSituation},
      {"backwards is slow",
       [](Inputs& i) {
         i.navigation = {-1.0, 0.0};
       },
       {-0.4, 0.0},
       Source::kNavigation,
       kReverse},
      {"person ahead",
       [](Inputs& i) {
         i.navigation = {1.4, 0.0}, i.person_ahead = true;
       },
       {1.0, 0.0},
       Source::kNavigation,
       kPersonAhead},
      {"person ahead, turning",
       [](Inputs& i) {
         i.navigation = {0.0, 1.0}, i.person_ahead = true;
       },
       {0.0, 0.5},
       Source::kNavigation,
       kPersonAhead},
      {"people unknown is a person ahead",
       [](Inputs& i) {
         i.navigation = {1.4, 0.0}, i.person_ahead.reset();
       },
       {1.0, 0.0},
       Source::kNavigation,
       kPersonAhead},
      {"a person in a confined place does not widen it",
       [](Inputs& i) {
         i.navigation = {1.4, 0.0}, i.person_ahead = true, i.situation = Situation::kConfined;
       },
       {0.8, 0.0},
       Source::kNavigation,
       kSituation},
      {"localization degraded",
       [](Inputs& i) {
         i.navigation = {1.0, 0.0}, i.localization = Localization::kDegraded;
       },
       {0.5, 0.0},
       Source::kNavigation,
       kLocalizationDegraded},
      {"localization lost stops, but may turn",
       [](Inputs& i) {
         i.navigation = {1.0, 0.4}, i.localization = Localization::kLost;
       },
       {0.0, 0.4},
       Source::kNavigation,
       kLocalizationLost},
      {"an operator drives without localization",
       [](Inputs& i) {
         i.manual = {0.6, 0.0}, i.localization = Localization::kLost;
       },
       {0.6, 0.0},
       Source::kManual,
       kNone},
      {"battery low",
       [](Inputs& i) {
         i.navigation = {1.4, 0.0}, i.low_battery = true;
       },
       {0.8, 0.0},
       Source::kNavigation,
       kLowBattery},
      {"something degraded",
       [](Inputs& i) {
         i.navigation = {1.4, 0.0}, i.enables->speed_factor = 0.5;
       },
       {0.7, 0.0},
       Source::kNavigation,
       kSpeedFactor},
      {"a speed factor of zero stops",
       [](Inputs& i) {
         i.navigation = {1.4, 0.3}, i.enables->speed_factor = 0.0;
       },
       {0.0, 0.0},
       Source::kNavigation,
       kSpeedFactor},
      {"a speed factor that is not a number stops",
       [](Inputs& i) {
         i.navigation = {1.4, 0.3}, i.enables->speed_factor = kNan;
       },
       {0.0, 0.0},
       Source::kNavigation,
       kSpeedFactor},

      {"front left whisker",
       [](Inputs& i) {
         i.navigation = {0.5, 0.3}, i.whiskers->front_left = true;
       },
       {0.0, 0.0},
       Source::kNavigation,
       kWhisker},
      {"front left whisker, turning away",
       [](Inputs& i) {
         i.navigation = {0.5, -0.3}, i.whiskers->front_left = true;
       },
       {0.0, -0.3},
       Source::kNavigation,
       kWhisker},
      {"a whisker stops the operator too",
       [](Inputs& i) {
         i.manual = {0.5, 0.0}, i.whiskers->front_right = true;
       },
       {0.0, 0.0},
       Source::kManual,
       kWhisker},
  };
  for (const Case& test : cases) {
    SCOPED_TRACE(test.name);
    Inputs inputs = all_well();
    test.change(inputs);
    const Decision decision = settled(inputs);
    EXPECT_NEAR(decision.twist.v, test.twist.v, 1e-12);
    EXPECT_NEAR(decision.twist.w, test.twist.w, 1e-12);
    EXPECT_EQ(decision.source, test.source);
    EXPECT_EQ(text(decision.limit), text(test.limit));
  }
}

TEST(MovementControl, WorksWithoutWhiskersWhereThereAreNone) {
  Inputs inputs = all_well();
  inputs.navigation = Twist2{0.5, 0.0};
  inputs.whiskers.reset();
  Parameters parameters;
  parameters.whiskers_required = false;
  EXPECT_EQ(settled(inputs, parameters).twist.v, 0.5);
}

TEST(WhiskerReflex, BrakesABalancingBaseAsFastAsItFollows) {
  Parameters parameters;
  parameters.largest_drop = 0.25;
  MovementControl control(parameters);
  Inputs inputs = all_well();
  const auto decide = [&](double wanted, double measured, bool touched, int at) {
    inputs.navigation = Twist2{wanted, 0.0};
    inputs.measured = Twist2{measured, 0.0};
    inputs.whiskers = Whiskers{.front_left = touched};
    return control.decide(inputs, milliseconds(at)).twist.v;
  };
  int now = 0;
  while (decide(0.7, 0.7, false, now += 40) < 0.7) {
  }
  EXPECT_NEAR(decide(0.7, 0.7, true, now += 20), 0.45, 1e-12);
  EXPECT_NEAR(decide(0.7, 0.6, true, now += 20), 0.35, 1e-12);
  EXPECT_EQ(decide(0.2, 0.6, true, now += 40), 0.35 - 1.4 * 0.04) << "never faster than wanted";
  EXPECT_EQ(decide(0.7, 0.25, true, now += 20), 0.0);
  EXPECT_EQ(decide(0.7, -0.6, true, now += 20), 0.0) << "it rolls back";
  inputs.measured.reset();
  EXPECT_EQ(control.decide(inputs, milliseconds(now += 20)).twist.v, 0.0);
  EXPECT_EQ(MovementControl().decide(inputs, milliseconds(0)).twist.v, 0.0);
}

/// MARVIN with its guard, half a metre before a wall.
class Guarded : public testing::Test {
 protected:
  Guarded() {
    parameters.guarded = true;
    parameters.largest_drop = 0.25;
    inputs = all_well();
    for (int i = -100; i <= 100; ++i) points.emplace_back(0.305 + 0.5, 0.01 * i);
    inputs.view = {.points = points, .sees = true};
  }
  Parameters parameters;
  std::vector<geometry::Point2> points;
  Inputs inputs;
};

TEST_F(Guarded, WhoDoesNotLookAheadDrivesNoFasterThanItStops) {
  inputs.manual = Twist2{0.8, 0.0};
  const Decision decision = settled(inputs, parameters);
  EXPECT_NEAR(decision.twist.v, (0.5 - 0.02) / 1.48, 1e-9);
  EXPECT_EQ(decision.limit, Limit::kObstacle);
  inputs.manual = Twist2{0.8, 0.1};
  const Twist2 arc = settled(inputs, parameters).twist;
  EXPECT_NEAR(arc.w / arc.v, 0.1 / 0.8, 1e-9) << "the arc stays";
  inputs.manual.reset();
  inputs.interaction = Twist2{0.8, 0.0};
  EXPECT_NEAR(settled(inputs, parameters).twist.v, (0.5 - 0.02) / 1.48, 1e-9);
}

TEST_F(Guarded, APlannerThatDoesNotLookAheadIsHeldBack) {
  inputs.navigation = Twist2{0.8, 0.1};
  MovementControl control(parameters);
  Decision decision;
  for (int ms = 0; ms < 3000; ms += 20) decision = control.decide(inputs, milliseconds(ms));
  EXPECT_NEAR(decision.twist.v, (0.5 - 0.08) / 1.48, 0.02) << "a corner is a little nearer";
  EXPECT_NEAR(decision.twist.w / decision.twist.v, 0.1 / 0.8, 1e-9) << "the arc stays";
  EXPECT_EQ(decision.limit, Limit::kObstacle);
  EXPECT_NEAR(control.status().max_current.linear, decision.twist.v, 1e-9);
  EXPECT_EQ(control.held_back(), 1U);
  inputs.navigation = Twist2{0.25, 0.0};  // 0.37 m to rest
  for (int ms = 3000; ms < 3100; ms += 20) decision = control.decide(inputs, milliseconds(ms));
  EXPECT_EQ(decision.twist.v, 0.25);
  inputs.navigation = Twist2{0.8, 0.0};
  control.decide(inputs, milliseconds(3100));
  EXPECT_EQ(control.held_back(), 2U);
  parameters.guarded = false;
  EXPECT_EQ(settled(inputs, parameters).twist.v, 0.8);
}

TEST_F(Guarded, AHeldBackPlannersRobotStaysOnItsArcWhileItIsFaster) {
  MovementControl control(parameters);
  inputs.navigation = inputs.measured = Twist2{0.8, 0.2};
  inputs.view = {.sees = true};
  int ms = 0;
  for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.view = {.sees = true, .cells = points};
  const Twist2 held = control.decide(inputs, milliseconds(ms += 20)).twist;
  EXPECT_NEAR(held.v, 0.55, 1e-12) << "at once, as much slower as it can follow";
  EXPECT_EQ(held.w, 0.2);
  inputs.measured = Twist2{0.4, 0.1};
  for (int i = 0; i < 5; ++i) control.decide(inputs, milliseconds(ms += 20));
  EXPECT_NEAR(control.status().current.w, 0.1, 1e-9);
}

TEST_F(Guarded, AHeldBackPlannersRobotRollsStraightOnWhereOnlyThatStopsInTime) {
  // In a door, bending right: the tail would swing into the post.
  const auto turn_of = [&](bool open) {
    MovementControl control(parameters);
    inputs.navigation = inputs.measured = Twist2{0.25, -0.5};
    inputs.view = {.sees = true};
    int ms = 0;
    for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
    points.clear();
    for (int i = 0; i < 20; ++i) points.emplace_back(-0.3 + 0.01 * i, 0.34);
    for (int i = -50; i < 50; ++i) points.emplace_back(open ? 2.0 : 0.4, 0.01 * i);
    inputs.view = {.points = points, .sees = true};
    return control.decide(inputs, milliseconds(ms += 20)).twist.w;
  };
  EXPECT_NEAR(turn_of(true), 0.0, 0.03);
  EXPECT_LT(turn_of(false), -0.4) << "straight on it meets something, too";
}

// Its planner brakes along a bend; the base, told zero, rolls on and keeps the turn (window 1015).
TEST_F(Guarded, ARobotThatWasToldToStandTurnsIntoNothingThatItMissesStraightOn) {
  const auto turn_of = [&](double measured, const std::vector<geometry::Point2>& seen) {
    MovementControl control(parameters);
    inputs.measured = Twist2{measured, -0.4};
    inputs.navigation = Twist2{0.0, -0.4};
    inputs.view = {.points = seen, .sees = true};
    Twist2 twist;
    for (int ms = 0; ms < 1000; ms += 20) twist = control.decide(inputs, milliseconds(ms)).twist;
    return twist.w;
  };
  const std::vector<geometry::Point2> beside{{-0.2, 0.345}, {-0.21, 0.345}};  // of its tail
  const std::vector<geometry::Point2> ahead{{0.33, -0.32}, {0.33, -0.31}};    // of a corner
  EXPECT_NEAR(turn_of(0.2, {}), -0.4, 1e-9);
  EXPECT_EQ(turn_of(0.2, beside), 0.0);
  EXPECT_NEAR(turn_of(0.2, ahead), -0.4, 1e-9) << "straight on it would meet that sooner";
}

TEST_F(Guarded, AHeldBackPlannersRobotTurnsOnWhereItsArcStopsInTime) {
  const auto turn = [&](std::size_t guessed) {
    MovementControl control(parameters);
    inputs.navigation = Twist2{0.8, -0.6};  // too fast for the wall, but it is slow still
    inputs.measured = Twist2{0.25, -0.2};
    inputs.view = {.points = points, .sees = true, .guessed = guessed};
    Twist2 twist;
    for (int ms = 0; ms < 200; ms += 20) twist = control.decide(inputs, milliseconds(ms)).twist;
    EXPECT_EQ(control.held_back(), 1U);
    return twist.w;
  };
  EXPECT_LT(turn(0), -0.05);
  for (int i = 0; i < 20; ++i) points.emplace_back(-0.3 + 0.01 * i, 0.32);
  EXPECT_LT(turn(20), -0.05) << "nobody saw what is beside it";
  EXPECT_EQ(turn(0), 0.0);
}

/// Bending left past the wall's end: straight on it would meet the wall before it stands.
TEST_F(Guarded, ATouchKeepsARollingRobotOnItsArcWhereStraightOnIsAWall) {
  const auto turn_of = [&](double measured, double ahead,
                           const std::vector<geometry::Point2>& seen) {
    MovementControl control(parameters);
    inputs.whiskers = Whiskers{};
    inputs.navigation = inputs.measured = Twist2{measured, 0.6};
    inputs.view = {.sees = true};
    int ms = 0;
    for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
    points.clear();
    for (int i = 0; i <= 30; ++i) points.emplace_back(0.305 + ahead, -0.3 + 0.01 * i);
    points.insert(points.end(), seen.begin(), seen.end());
    inputs.view = {.points = points, .sees = true};
    inputs.whiskers = Whiskers{.front_left = true};
    inputs.navigation = Twist2{0.2, 0.6};
    return control.decide(inputs, milliseconds(ms += 20)).twist.w;
  };
  std::vector<geometry::Point2> beside;
  EXPECT_EQ(turn_of(0.6, 0.8, beside), 0.6);
  EXPECT_EQ(turn_of(0.6, 2.0, beside), 0.0) << "it stands before the wall: the corner is spared";
  EXPECT_EQ(turn_of(0.05, 0.8, beside), 0.0) << "it stands";
  for (int i = 0; i < 20; ++i) beside.emplace_back(0.5, 0.34 + 0.01 * i);
  EXPECT_EQ(turn_of(0.6, 0.8, beside), 0.0) << "the arc meets something sooner";
}

/// Turned by 1.05 rad, its nose to the left, in a corridor of 1.4 m, where MARVIN's front left and
/// back right whiskers touch the walls.
class InACorridor : public Guarded {
 protected:
  InACorridor() {
    left = wall(0.7);
    right = wall(-0.7);
    both = left;
    both.insert(both.end(), right.begin(), right.end());
    inputs.view.points = both;
    inputs.whiskers = Whiskers{.front_left = true, .back_right = true};
    inputs.navigation = Twist2{0.0, 0.8};
  }
  static std::vector<geometry::Point2> wall(double y) {
    std::vector<geometry::Point2> points;
    for (int i = -40; i <= 40; ++i)
      points.push_back(inverse(geometry::Pose2{0.0, 0.0, 1.05}) * geometry::Point2(0.05 * i, y));
    return points;
  }
  /// What a base that follows is told in the end, or one that is held.
  double turn(bool is_held = false) {
    MovementControl control(parameters);
    const Twist2 rolls = inputs.measured.value_or(Twist2{});
    Decision decision;
    for (int i = 0; i < 250; ++i) {
      decision = control.decide(inputs, milliseconds(20 * i));
      inputs.measured = Twist2{rolls.v, is_held ? 0.0 : decision.twist.w};
    }
    inputs.measured = rolls;
    limit = decision.limit;
    return decision.twist.w;
  }

  std::vector<geometry::Point2> left, right, both;
  Limit limit{};
  const double creeping = 0.05 / std::hypot(0.305, 0.33);  ///< [rad/s] of the corners' 0.05 m/s
};

TEST_F(InACorridor, TurnsOnCreepingBesideWhatTheLaserSaw) {
  EXPECT_NEAR(turn(), creeping, 1e-9);
  EXPECT_EQ(limit, Limit::kWhisker);
  inputs.view.sees = false;
  EXPECT_NEAR(turn(), creeping, 1e-9) << "the laser is too near to measure what was seen";
  inputs.view.sees = true;
  inputs.navigation.reset();
  inputs.manual = Twist2{0.0, 0.8};
  EXPECT_NEAR(turn(), creeping, 1e-9) << "an operator";
  inputs.manual = Twist2{0.0, 0.05};
  EXPECT_NEAR(turn(), 0.05, 1e-9) << "slower, if that is meant";
}

TEST_F(InACorridor, TurnsOnCreepingBesideWhatTheCostsKnow) {
  const std::vector<geometry::Point2> elsewhere{{2.0, 0.0}};
  inputs.people = elsewhere;
  inputs.view.points = left;
  inputs.view.cells = right;
  EXPECT_NEAR(turn(), creeping, 1e-9) << "the laser has forgotten the wall behind";
  inputs.view.points = {};
  inputs.view.cells = both;
  EXPECT_NEAR(turn(), creeping, 1e-9);
  EXPECT_EQ(turn(true), 0.0) << "something unknown before the wall";
  inputs.localization = Localization::kDegraded;
  EXPECT_EQ(turn(), 0.0) << "where are the map's walls?";
}

TEST_F(InACorridor, WhatTheCostsKnowMayBeSomebody) {
  inputs.view.cells = both;
  inputs.view.points = {};
  EXPECT_EQ(turn(), 0.0) << "nobody tells of people";
  for (const double away : {0.3, 0.8}) {
    const std::vector<geometry::Point2> behind{{-0.5 - away, -0.35}};
    inputs.people = behind;
    EXPECT_EQ(turn() > 0.0, away > 0.5) << away;
  }
}

TEST_F(InACorridor, TurnsIntoNothingThatNobodyKnows) {
  inputs.view.points = left;
  EXPECT_EQ(turn(), 0.0) << "what is at the back right corner?";
  const std::vector<geometry::Point2> marks(2, {-0.4, -0.35}), elsewhere{{2.0, 0.0}};
  inputs.people = elsewhere;
  inputs.view.cells = marks;
  EXPECT_EQ(turn(), 0.0) << "the costs have the touch's own mark";
  inputs.view.cells = {};
  inputs.view.points = right;
  EXPECT_EQ(turn(), 0.0) << "and at the front left one?";
  inputs.view.points = both;
  inputs.view.guessed = right.size();
  EXPECT_EQ(turn(), 0.0) << "nobody has seen the wall on the right";
  inputs.view.guessed = 0;
  inputs.view.points = {};
  EXPECT_EQ(turn(), 0.0) << "no scan any more";
  inputs.view.points = both;
  parameters.guarded = false;
  EXPECT_EQ(turn(), 0.0) << "nothing looks at the outline";
}

TEST_F(InACorridor, ATurnThatIsHeldEndsUntilTheTouchDoes) {
  EXPECT_EQ(turn(true), 0.0) << "something unseen before the wall";
  MovementControl control(parameters);
  Time now{};
  const auto told = [&](double measured, int turns) {
    Decision decision;
    for (int i = 0; i < turns; ++i) {
      inputs.measured = Twist2{0.0, measured};
      decision = control.decide(inputs, now += milliseconds(20));
    }
    return decision.twist.w;
  };
  EXPECT_GT(told(0.0, 40), 0.0) << "it may take a while to begin";
  EXPECT_EQ(told(0.0, 60), 0.0);
  EXPECT_EQ(told(0.1, 100), 0.0) << "whatever it does then";
  const auto touches = std::exchange(inputs.whiskers, Whiskers{});
  told(0.1, 1);
  inputs.whiskers = touches;
  EXPECT_GT(told(0.1, 10), 0.0);
}

TEST_F(InACorridor, ATouchOfWhatIsKnownBarsTheWayThereAsAnyOther) {
  for (const double v : {0.5, -0.5}) {
    for (const double w : {0.0, 0.5}) {
      inputs.navigation = Twist2{v, w};
      EXPECT_EQ(settled(inputs, parameters).twist, Twist2{}) << v << " " << w;
    }
  }
}

TEST_F(InACorridor, ARollingBaseTurnsIntoNoTouch) {
  inputs.measured = Twist2{0.2, 0.0};
  EXPECT_EQ(turn(), 0.0);
}

TEST_F(InACorridor, TheGuardEndsATurnBeforeACornerMeetsWhatIsSeen) {
  // A post just outside of the front left corner's way, and one in it.
  const auto turns_beside = [&](double radius) {
    const double angle = std::atan2(0.33, 0.305) + 0.05;
    both.resize(left.size() + right.size());
    for (int i = 0; i < 2; ++i)
      both.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    inputs.view.points = both;
    return turn();
  };
  EXPECT_GT(turns_beside(0.46), 0.0);
  EXPECT_EQ(turns_beside(0.44), 0.0);
}

/// Flush with a wall on its right, which both whiskers there touch: of the bend that its planner
/// wants, away from the post that the wall ends in, they leave a part.
TEST_F(Guarded, WhatTheWhiskersLeaveOfABendLeadsIntoNothingThatWasSeen) {
  for (const double ahead : {0.02, 0.3}) {
    points.clear();
    for (int i = 0; i < 5; ++i) points.emplace_back(0.305 + ahead, -0.25 - 0.01 * i);
    inputs.view = {.points = points, .sees = true};
    inputs.whiskers = Whiskers{.front_right = true, .back_right = true};
    inputs.manual.reset();
    inputs.navigation = Twist2{0.1, 0.8};
    EXPECT_EQ(settled(inputs, parameters).twist.v > 0.0, ahead > 0.1) << ahead;
  }
}

TEST_F(Guarded, ALostPlannerMayTurn) {
  inputs.navigation = Twist2{0.8, 0.3};
  inputs.localization = Localization::kLost;
  const Decision decision = settled(inputs, parameters);
  EXPECT_EQ(decision.twist, (Twist2{0.0, 0.3}));
  EXPECT_EQ(decision.limit, Limit::kLocalizationLost);
}

TEST_F(Guarded, SlowsDownAtOnceForWhatAppears) {
  MovementControl control(parameters);
  inputs.manual = Twist2{0.8, 0.0};
  inputs.view = {.sees = true};
  int ms = 0;
  for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.view = {.points = points, .sees = true};
  EXPECT_NEAR(control.decide(inputs, milliseconds(ms)).twist.v, (0.5 - 0.02) / 1.48, 1e-9);
}

TEST_F(Guarded, WithoutAScanItCreeps) {
  inputs.manual = Twist2{0.8, 0.0};
  inputs.view = {};
  const Decision decision = settled(inputs, parameters);
  EXPECT_NEAR(decision.twist.v, 0.1, 1e-9);
  EXPECT_EQ(decision.limit, Limit::kBlind);
}

// A jacket over the front half of the laser: its costs are free there.
TEST_F(Guarded, ANavigationThatSeesNothingAheadCreeps) {
  const double corner = parameters.guard.outline.circumscribed_radius();
  for (const Twist2& wish : {Twist2{0.8, 0.3}, Twist2{0.0, 0.8}, Twist2{0.09, -0.3}}) {
    inputs.navigation = wish;
    inputs.view = {};
    const Decision decision = settled(inputs, parameters);
    EXPECT_NEAR(decision.twist.v + std::abs(decision.twist.w) * corner, 0.1, 1e-9);
    EXPECT_NEAR(decision.twist.w * wish.v, wish.w * decision.twist.v, 1e-9) << "on its arc";
    EXPECT_EQ(decision.limit, Limit::kBlind);
  }
  inputs.navigation = Twist2{0.8, 0.3};
  inputs.view = {.sees = true};
  EXPECT_EQ(settled(inputs, parameters).twist, (Twist2{0.8, 0.3}));
}

// The laser freezes in a bend: the planner brakes, with the turn that keeps the base on its arc
// while it rolls out, and means no turn on the spot (window 8273).
TEST_F(Guarded, ABlindPlannersRobotRollsOutOnItsArc) {
  // From 0.47 m/s on; it is as fast as `measured` after 0.4 s, and told to turn after `seconds`.
  const auto turn_of = [&](const Twist2& wish, double measured, double seconds = 0.8) {
    MovementControl control(parameters);
    inputs.navigation = inputs.measured = Twist2{0.47, -0.5};
    inputs.view = {.sees = true};
    int ms = 0;
    for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
    inputs.navigation = wish;
    inputs.view = {};
    for (const int end = ms + static_cast<int>(1e3 * seconds); ms < end; ms += 20) {
      if (ms == 3400) inputs.measured = Twist2{measured, -0.5};
      control.decide(inputs, milliseconds(ms));
    }
    EXPECT_NEAR(control.status().current.v, wish.v, 1e-3);
    return control.status().current.w;
  };
  const double creeps = 0.1 / parameters.guard.outline.circumscribed_radius();
  EXPECT_NEAR(turn_of({0.0, -0.5}, 0.47), -0.5, 1e-9);
  EXPECT_NEAR(turn_of({0.0, -0.4}, 0.47), -0.4, 1e-9) << "no more than it is meant";
  EXPECT_NEAR(turn_of({0.0, -0.8}, 0.47), -0.5, 1e-9) << "no more than it was told";
  EXPECT_NEAR(turn_of({0.0, -0.5}, 0.3), -0.5 * 0.3 / 0.47, 1e-9) << "the arc";
  EXPECT_NEAR(turn_of({0.0, -0.5}, 0.05), -creeps, 1e-9) << "it stands and turns on the spot";
  EXPECT_NEAR(turn_of({0.0, -0.5}, -0.2), -creeps, 1e-9) << "it sways back";
  EXPECT_NEAR(turn_of({0.0, 0.5}, 0.47), creeps, 1e-9) << "another way than it goes";
  EXPECT_NEAR(turn_of({0.001, 0.5}, 0.47), creeps, 2e-3) << "and nearly nothing is nothing";
  EXPECT_NEAR(turn_of({0.0, -0.5}, 0.47, 3.0), -creeps, 1e-9) << "no base rolls for so long";
}

// In a bend along a wall the stick is let go: straight on the robot would roll into the wall.
TEST_F(Guarded, RollsOutOnTheArcWhereItWouldMeetSomethingElse) {
  MovementControl control(parameters);
  inputs.measured = Twist2{0.6, 0.5};
  inputs.manual = Twist2{0.6, 0.5};
  inputs.view = {.sees = true};
  int ms = 0;
  for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  for (const double wish : {0.0, -0.3}) {
    inputs.manual = Twist2{wish, 0.0};
    inputs.view = {.points = points, .sees = true};
    EXPECT_NEAR(control.decide(inputs, milliseconds(ms += 20)).twist.w, 0.5, 1e-9) << wish;
  }
  inputs.view = {.sees = true};
  EXPECT_LT(control.decide(inputs, milliseconds(ms += 20)).twist.w, 0.5) << "room enough";
}

TEST(MovementControl, KeepsNoArcWithoutMotors) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = inputs.measured = Twist2{0.8, 0.4};
  for (int ms = 0; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.enables.reset();
  EXPECT_NEAR(control.decide(inputs, milliseconds(3000)).twist.w, 0.4, 1e-9);
  inputs.measured.reset();
  EXPECT_NEAR(control.decide(inputs, milliseconds(3020)).twist.w, 0.4, 1e-9) << "unmeasured";
  inputs.motors_off = true;
  EXPECT_EQ(control.decide(inputs, milliseconds(3040)).twist, Twist2{});
}

TEST(MovementControl, SpeedsUpWithinTheAccelerationAndStopsAtOnce) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = Twist2{1.0, 1.0};
  EXPECT_EQ(control.decide(inputs, milliseconds(0)).twist, (Twist2{0.0, 0.0}));
  EXPECT_NEAR(control.decide(inputs, milliseconds(20)).twist.v, 0.7 * 0.02, 1e-12);
  EXPECT_NEAR(control.decide(inputs, milliseconds(40)).twist.w, 1.5 * 0.04, 1e-12);
  EXPECT_EQ(control.status().limit, Limit::kAcceleration);
  for (int ms = 60; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  EXPECT_EQ(control.status().current, (Twist2{1.0, 1.0}));
  inputs.navigation = Twist2{0.5, 1.0};
  EXPECT_NEAR(control.decide(inputs, milliseconds(3000)).twist.v, 1.0 - 1.4 * 0.02, 1e-12);
  inputs.navigation = Twist2{0.0, 0.0};
  EXPECT_EQ(control.decide(inputs, milliseconds(3001)).twist, (Twist2{0.0, 0.0}));
}

/// For an operator.
TEST(Jerk, BoundsHowFastTheAccelerationChanges) {
  MovementControl control(with_jerk());
  Inputs inputs = all_well();
  inputs.manual = Twist2{0.8, 0.8};
  Twist2 last, acceleration;
  double fastest = 0.0;
  for (int ms = 0; ms < 4000; ms += 20) {
    if (ms == 2400) inputs.manual = Twist2{0.4, 0.2};
    const Twist2 now = control.decide(inputs, milliseconds(ms)).twist;
    const Twist2 gain{(now.v - last.v) / 0.02, (now.w - last.w) / 0.02};
    if (std::abs(gain.v) > std::abs(acceleration.v)) {
      EXPECT_LE(std::abs(gain.v - acceleration.v), 1.0 * 0.02 + 1e-9) << ms;
    }
    if (std::abs(gain.w) > std::abs(acceleration.w)) {
      EXPECT_LE(std::abs(gain.w - acceleration.w), 4.0 * 0.02 + 1e-9) << ms;
    }
    fastest = std::max(fastest, gain.v);
    last = now, acceleration = gain;
    if (ms == 2380) {
      EXPECT_EQ(now, (Twist2{0.8, 0.8})) << "it gets there";
    }
  }
  EXPECT_EQ(last, (Twist2{0.4, 0.2}));
  EXPECT_NEAR(fastest, 0.7, 1e-9) << "and the acceleration is reached";
}

TEST(Jerk, DelaysNoStopNoWhiskerAndNoNavigation) {
  Inputs inputs = all_well();
  inputs.manual = Twist2{0.8, 0.0};
  MovementControl control(with_jerk());
  int ms = 0;
  for (; ms < 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.manual = Twist2{0.0, 0.0};
  EXPECT_EQ(control.decide(inputs, milliseconds(ms += 20)).twist.v, 0.0);
  inputs.manual = Twist2{0.8, 0.0};
  for (const int until = ms + 600; ms < until; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.whiskers->front_left = true;
  EXPECT_EQ(control.decide(inputs, milliseconds(ms += 20)).twist.v, 0.0);
  inputs.whiskers->front_left = false;
  EXPECT_LE(control.decide(inputs, milliseconds(ms += 20)).twist.v, 1.0 * 0.02 * 0.02 + 1e-9)
      << "after that it builds up anew";

  inputs.navigation = inputs.manual;
  inputs.manual.reset();
  MovementControl planned(with_jerk()), plain;
  for (ms = 0; ms < 1000; ms += 20)
    EXPECT_EQ(planned.decide(inputs, milliseconds(ms)).twist,
              plain.decide(inputs, milliseconds(ms)).twist);
}

TEST(Jerk, TurnsBackOnlyWhenTheBaseStands) {
  MovementControl control(with_jerk());
  Inputs inputs = all_well();
  inputs.manual = Twist2{0.5, 0.0};
  int ms = 0;
  inputs.measured = Twist2{-0.2, 0.0};  // it leans to start
  for (; ms < 2000; ms += 20) control.decide(inputs, milliseconds(ms));
  EXPECT_EQ(control.decide(inputs, milliseconds(ms)).twist.v, 0.5);
  inputs.manual = Twist2{-0.3, 0.0};
  inputs.measured = Twist2{0.5, 0.0};
  for (; ms < 3000; ms += 20) EXPECT_EQ(control.decide(inputs, milliseconds(ms)).twist.v, 0.0);
  inputs.measured = Twist2{0.05, 0.0};
  for (; ms < 5000; ms += 20) control.decide(inputs, milliseconds(ms));
  EXPECT_NEAR(control.decide(inputs, milliseconds(ms)).twist.v, -0.3, 1e-9);
}

TEST(MovementControl, ReversesThroughZero) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = Twist2{0.5, 0.0};
  int ms = 0;
  for (; ms < 2000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.navigation = Twist2{-0.3, 0.0};
  const double first = control.decide(inputs, milliseconds(ms)).twist.v;
  EXPECT_LE(first, 0.0);
  EXPECT_GE(first, -0.7 * 0.04);
}

TEST(MovementControl, StopRateIsKeptWhereOneIsSet) {
  Parameters parameters;
  parameters.linear.stop = 2.0;
  MovementControl control(parameters);
  Inputs inputs = all_well();
  inputs.navigation = Twist2{1.0, 0.0};
  for (int ms = 0; ms <= 3000; ms += 20) control.decide(inputs, milliseconds(ms));
  inputs.navigation = Twist2{0.0, 0.0};
  EXPECT_NEAR(control.decide(inputs, milliseconds(3020)).twist.v, 1.0 - 0.04, 1e-12);
  // But not for what must not move at all.
  inputs.enables.reset();
  EXPECT_EQ(control.decide(inputs, milliseconds(3040)).twist.v, 0.0);
}

TEST(MovementControl, DecidesTheSameHoweverOftenItIsAsked) {
  Inputs inputs = all_well();
  inputs.navigation = Twist2{1.4, 0.7};
  MovementControl often;
  MovementControl rarely;
  for (int ms = 0; ms <= 1000; ++ms) {
    often.decide(inputs, milliseconds(ms));
    often.decide(inputs, milliseconds(ms));
    if (ms % 20 == 0) rarely.decide(inputs, milliseconds(ms));
  }
  EXPECT_NEAR(often.status().current.v, rarely.status().current.v, 1e-9);
  EXPECT_NEAR(often.status().current.w, rarely.status().current.w, 1e-9);
}

TEST(MovementControl, APauseGivesNoLeap) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = Twist2{1.4, 0.0};
  control.decide(inputs, milliseconds(0));
  EXPECT_NEAR(control.decide(inputs, milliseconds(60000)).twist.v, 0.7 * 0.04, 1e-12);
}

TEST(MovementControl, ReportsAppendixA1) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.navigation = Twist2{0.5, 0.0};
  inputs.measured = Twist2{2.0, 0.0};
  inputs.whiskers->back_left = true;
  for (int ms = 0; ms <= 600; ms += 10) control.decide(inputs, milliseconds(ms));
  const MovementStatus& status = control.status();
  EXPECT_TRUE(status.enables.movement && status.enables.navigation);
  EXPECT_EQ(status.max_human.linear, 1.0);
  EXPECT_EQ(status.max_human.angular, 0.5);
  EXPECT_EQ(status.max_normal.linear, 1.4);
  EXPECT_EQ(status.max_normal.angular, 1.0);
  EXPECT_EQ(status.threshold_linear.threshold, 0.5);
  EXPECT_EQ(status.max_current.linear, 1.4);
  EXPECT_EQ(status.measured.v, 2.0);
  EXPECT_LT(status.error_linear.error, -1.0);
  EXPECT_EQ(status.error_linear.lasting, milliseconds(600));
  EXPECT_TRUE(status.whiskers.back_left);
  EXPECT_TRUE(status.base_connected);
  EXPECT_TRUE(status.ok);
  EXPECT_EQ(status.source, Source::kNavigation);
  inputs.measured.reset();
  control.decide(inputs, milliseconds(620));
  EXPECT_FALSE(control.status().base_connected);
  EXPECT_FALSE(control.status().ok);
}

TEST(MovementControl, CountsNonsense) {
  MovementControl control;
  Inputs inputs = all_well();
  inputs.manual = Twist2{0.0, std::numeric_limits<double>::infinity()};
  control.decide(inputs, milliseconds(0));
  control.decide(inputs, milliseconds(20));
  EXPECT_EQ(control.rejected(), 2U);
}

}  // namespace
}  // namespace usher::movement_control
