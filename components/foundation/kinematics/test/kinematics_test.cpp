#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "foundation/kinematics/acceleration_limiter.hpp"
#include "foundation/kinematics/differential_drive.hpp"
#include "foundation/kinematics/roll_out.hpp"
#include "foundation/kinematics/stopping_distance.hpp"
#include "foundation/kinematics/whisker_reflex.hpp"
#include "foundation/kinematics/whisker_rods.hpp"
#include "foundation/random/random.hpp"

namespace usher::kinematics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(DifferentialDrive, InverseUndoesForward) {
  const DifferentialDrive drive{0.47};
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const geometry::Twist2 twist{random.uniform(-2, 2), random.uniform(-3, 3)};
    const geometry::Twist2 back = drive.forward(drive.inverse(twist));
    EXPECT_NEAR(back.v, twist.v, 1e-12);
    EXPECT_NEAR(back.w, twist.w, 1e-12);
  }
}

TEST(DifferentialDrive, TurnsLeftWhenTheRightWheelIsFaster) {
  EXPECT_EQ(DifferentialDrive{0.5}.forward({0.5, 1.0}), (geometry::Twist2{0.75, 1.0}));
}

TEST(DifferentialDrive, LimitKeepsTheCurvature) {
  const DifferentialDrive drive{0.5};
  const geometry::Twist2 limited = drive.limited({1.0, 2.0}, 1.0);
  EXPECT_NEAR(drive.inverse(limited).right, 1.0, 1e-12);
  EXPECT_NEAR(limited.w / limited.v, 2.0, 1e-12);
  EXPECT_EQ(drive.limited({0.3, 0.1}, 1.0), (geometry::Twist2{0.3, 0.1}));
}

TEST(DifferentialDrive, RollingAQuarterCircleEndsBesideTheStart) {
  const DifferentialDrive drive{0.5};
  const double turn = geometry::kPi / 2;
  const geometry::Pose2 end = drive.rolled({0, 0, 0}, turn * 0.75, turn * 1.25);
  EXPECT_NEAR(end.x, 1.0, 1e-12);
  EXPECT_NEAR(end.y, 1.0, 1e-12);
  EXPECT_NEAR(end.yaw, turn, 1e-12);
}

TEST(StoppingDistance, DefaultIsTheMeasuredTable) {
  const StoppingDistance model;
  EXPECT_DOUBLE_EQ(model.distance(1.0), 1.48);
  EXPECT_DOUBLE_EQ(model.distance(1.4), 2.08);
  EXPECT_DOUBLE_EQ(model.distance(0.5), 0.74);
  EXPECT_NEAR(model.distance(1.15), 1.48 + 0.15 * 1.5, 1e-12);
  EXPECT_NEAR(model.distance(2.0), 2.08 + 0.6 * 1.5, 1e-12);
}

TEST(StoppingDistance, IsZeroAtRestAndSymmetric) {
  const StoppingDistance model;
  EXPECT_EQ(model.distance(0.0), 0.0);
  EXPECT_EQ(model.distance(-0.7), model.distance(0.7));
}

TEST(StoppingDistance, SpeedIsTheInverse) {
  const std::array points{StoppingPoint{0.3, 0.2}, StoppingPoint{1.0, 1.5},
                          StoppingPoint{1.4, 2.6}};
  const StoppingDistance model = StoppingDistance::make(points).value();
  for (int i = 0; i < 300; ++i) {
    const double v = 0.01 * i;
    EXPECT_NEAR(model.speed(model.distance(v)), v, 1e-12);
  }
}

TEST(StoppingDistance, HasNoSpeedWithoutRoom) {
  const StoppingDistance model;
  EXPECT_EQ(model.speed(0.0), 0.0);
  EXPECT_EQ(model.speed(-1.0), 0.0);
  EXPECT_EQ(model.speed(kNaN), 0.0);
}

TEST(StoppingDistance, RefusesTablesThatDoNotGrow) {
  const std::vector<std::vector<StoppingPoint>> tables{{},
                                                       {{0.0, 0.1}},
                                                       {{1.0, 0.0}},
                                                       {{1.0, 1.0}, {1.0, 1.2}},
                                                       {{1.0, 1.0}, {1.2, 0.9}},
                                                       {{kNaN, 1.0}},
                                                       {{1.0, kInfinity}}};
  for (const auto& table : tables) EXPECT_FALSE(StoppingDistance::make(table).ok());
  EXPECT_NE(StoppingDistance::make(tables[4]).error().find("1.2"), std::string::npos);
}

TEST(AccelerationLimiter, ReachesTheTargetInTimeAndNoSooner) {
  const AccelerationLimits limits{
      .acceleration = 0.7, .deceleration = 1.0, .angular_acceleration = 2.0};
  geometry::Twist2 command;
  for (int i = 0; i < 10; ++i) command = limited(command, {1.0, -1.0}, limits, 0.1);
  EXPECT_NEAR(command.v, 0.7, 1e-12);
  EXPECT_NEAR(command.w, -1.0, 1e-12);
}

TEST(AccelerationLimiter, BrakesWithTheDeceleration) {
  const AccelerationLimits limits{
      .acceleration = 0.5, .deceleration = 2.0, .angular_acceleration = 2.0};
  EXPECT_DOUBLE_EQ(limited({1.0, 0.0}, {0.0, 0.0}, limits, 0.1).v, 0.8);
  EXPECT_DOUBLE_EQ(limited({-1.0, 0.0}, {0.0, 0.0}, limits, 0.1).v, -0.8);
}

TEST(AccelerationLimiter, ReversesThroughZero) {
  const AccelerationLimits limits{
      .acceleration = 1.0, .deceleration = 10.0, .angular_acceleration = 2.0};
  EXPECT_EQ(limited({0.2, 0.0}, {-1.0, 0.0}, limits, 0.1).v, 0.0);
  EXPECT_DOUBLE_EQ(limited({0.0, 0.0}, {-1.0, 0.0}, limits, 0.1).v, -0.1);
}

TEST(AccelerationLimiter, BrakesOnNonsense) {
  const AccelerationLimits limits;
  EXPECT_LT(limited({1.0, 0.0}, {kNaN, 0.0}, limits, 0.1).v, 1.0);
  EXPECT_EQ(limited({1.0, 0.0}, {0.0, 0.0}, limits, -1.0).v, 1.0);
  EXPECT_EQ(limited({1.0, 0.0}, {0.0, 0.0}, limits, kNaN).v, 1.0);
}

using std::chrono::milliseconds;

/// Every 20 ms until then the same measurement; what it is told at last.
geometry::Twist2 stop_until(RollOut& roll_out, int from_ms, int to_ms,
                            const std::optional<geometry::Twist2>& measured) {
  for (int ms = from_ms; ms < to_ms; ms += 20) roll_out.stop(measured, milliseconds(ms));
  return roll_out.stop(measured, milliseconds(to_ms));
}

TEST(RollOut, LeavesWhatABaseIsToldWhereNobodyTellsItAnyMore) {
  using std::chrono::milliseconds;
  const StoppingDistance marvin;
  RollOut base;
  base.drive({0.5, 0.6}, milliseconds(1000));
  base.drive({0.5, 0.6}, milliseconds(1100));
  EXPECT_EQ(base.rest(marvin).twist, (geometry::Twist2{0.0, 0.6}));
  EXPECT_EQ(base.rest(marvin).lasts, milliseconds(1000));
  base.stop(geometry::Twist2{0.5, 0.6}, milliseconds(1110));
  base.stop(geometry::Twist2{0.25, 0.3}, milliseconds(1300));
  EXPECT_NEAR(base.rest(marvin).twist.w, 0.3, 1e-9) << "half as fast";
  base.stop(geometry::Twist2{0.25, 0.3}, milliseconds(1490));
  EXPECT_EQ(base.rest(marvin).lasts, milliseconds(810)) << "no stop from 0.5 m/s takes longer";
  base.stop(geometry::Twist2{0.0, 0.0}, milliseconds(1500));
  EXPECT_EQ(base.rest(marvin).lasts, milliseconds(0)) << "it stands";
  const StoppingPoint point{0.5, 0.25};
  base.drive({0.5, 0.6}, milliseconds(1600));
  EXPECT_EQ(base.rest(StoppingDistance::make({&point, 1}).value()).lasts, milliseconds(500))
      << "no farther round than along its arc";
  RollOut straight, on_the_spot;
  straight.drive({0.5, 0.01}, milliseconds(1000));
  on_the_spot.drive({0.0, 0.6}, milliseconds(1000));
  EXPECT_EQ(straight.rest(marvin).lasts, milliseconds(0));
  EXPECT_EQ(on_the_spot.rest(marvin).lasts, milliseconds(0));
}

TEST(RollOut, KeepsTheArcWhileTheSpeedFalls) {
  RollOut roll_out;
  EXPECT_EQ(roll_out.stop(geometry::Twist2{0.8, 0.4}, milliseconds(0)), (geometry::Twist2{0, 0.4}));
  const auto later = roll_out.stop(geometry::Twist2{0.4, 0.1}, milliseconds(500));
  EXPECT_EQ(later.v, 0.0);
  EXPECT_NEAR(later.w, 0.2, 1e-12) << "the curvature of the beginning";
  EXPECT_EQ(roll_out.stop(geometry::Twist2{0.9, 0.1}, milliseconds(600)).w, 0.4) << "never faster";
}

TEST(RollOut, IsZeroForARobotThatStandsTurnsBackOrIsUnknown) {
  const auto stop = [](geometry::Twist2 onset, std::optional<geometry::Twist2> now, int ms) {
    RollOut roll_out;
    roll_out.stop(onset, milliseconds(0));
    return stop_until(roll_out, 20, ms, now);
  };
  const geometry::Twist2 arc{0.8, 0.4}, zero;
  EXPECT_NE(stop(arc, arc, 100), zero);
  EXPECT_EQ(stop(arc, geometry::Twist2{0.05, 0.4}, 100), zero);
  EXPECT_EQ(stop(arc, geometry::Twist2{-0.3, 0.4}, 100), zero) << "it sways back";
  EXPECT_EQ(stop({0.05, 0.8}, geometry::Twist2{0.05, 0.8}, 100), zero) << "it turned on the spot";
  EXPECT_EQ(stop({kNaN, 0.4}, geometry::Twist2{kNaN, 0.4}, 100), zero)
      << "nobody knows how it moves";
  EXPECT_NE(stop(arc, arc, 1600), zero);
  EXPECT_EQ(stop(arc, arc, 1700), zero) << "measurements that hang turn it no longer";
  EXPECT_EQ(stop({0.3, 0.4}, geometry::Twist2{0.3, 0.4}, 900), zero) << "a slow one stands sooner";
}

TEST(RollOut, BelievesNoMeasurementOfARobotThatMustStandByNow) {
  const geometry::Twist2 arc{0.8, 0.4}, zero;
  RollOut roll_out;
  roll_out.drive(arc, milliseconds(0));
  for (int ms = 20; ms < 1600; ms += 20) roll_out.drive({0.0, 0.4}, milliseconds(ms));
  EXPECT_EQ(roll_out.stop(arc, milliseconds(1600)).w, 0.4);
  roll_out.drive({0.0, 0.0}, milliseconds(1620));
  EXPECT_EQ(roll_out.stop(arc, milliseconds(1700)), zero) << "it hangs";
}

TEST(RollOut, GoesOnTurningForASecondWhereNothingMeasures) {
  const geometry::Twist2 arc{0.8, 0.4}, slower{0.4, 0.1}, zero;
  RollOut lost;
  lost.stop(arc, milliseconds(0));
  stop_until(lost, 20, 500, slower);
  EXPECT_NEAR(lost.stop(std::nullopt, milliseconds(600)).w, 0.2, 1e-12) << "as it was last";
  EXPECT_NEAR(stop_until(lost, 620, 1400, geometry::Twist2{kNaN, 0.1}).w, 0.2, 1e-12);
  EXPECT_EQ(lost.stop(std::nullopt, milliseconds(1500)), zero);
  RollOut blind;
  blind.drive(arc, milliseconds(4990));
  EXPECT_EQ(blind.stop(std::nullopt, milliseconds(5000)).w, 0.4) << "as it was told";
  EXPECT_EQ(stop_until(blind, 5020, 5980, std::nullopt).w, 0.4);
  EXPECT_NEAR(blind.stop(slower, milliseconds(5995)).w, 0.2, 1e-12) << "measured again";
  EXPECT_EQ(blind.stop(geometry::Twist2{0.0, 0.4}, milliseconds(6000)), zero);
  EXPECT_EQ(blind.stop(std::nullopt, milliseconds(6010)), zero) << "it stood";
  RollOut slow;
  slow.drive({0.2, 0.4}, milliseconds(0));
  EXPECT_EQ(stop_until(slow, 20, 730, std::nullopt), zero) << "a slow one stands sooner";
  slow.drive({0.2, 0.4}, milliseconds(1000));
  EXPECT_EQ(stop_until(slow, 1020, 1700, std::nullopt).w, 0.4);
  EXPECT_EQ(slow.stop(std::nullopt, milliseconds(1800)), zero);
  RollOut creeping;  // it rolls on after a faster command
  creeping.drive(arc, milliseconds(0));
  for (int ms = 20; ms <= 400; ms += 20) creeping.drive({0.05, 0.4}, milliseconds(ms));
  EXPECT_EQ(creeping.stop(std::nullopt, milliseconds(420)).w, 0.4);
  for (int ms = 440; ms <= 2400; ms += 20) creeping.drive({0.05, 0.4}, milliseconds(ms));
  EXPECT_EQ(creeping.stop(std::nullopt, milliseconds(2420)), zero);
  RollOut turning;
  turning.drive({0.0, 0.8}, milliseconds(0));
  EXPECT_EQ(turning.stop(std::nullopt, milliseconds(20)), zero) << "on the spot";
  RollOut led;  // by somebody who already keeps the arc
  led.drive(arc, milliseconds(3000));
  for (int ms = 3020; ms <= 3500; ms += 20) led.drive({0.0, 0.3}, milliseconds(ms));
  EXPECT_EQ(led.stop(std::nullopt, milliseconds(3600)), (geometry::Twist2{0.0, 0.3}));
  EXPECT_EQ(stop_until(led, 3620, 4000, std::nullopt), zero);
  EXPECT_EQ(RollOut().stop(std::nullopt, milliseconds(0)), zero);
}

TEST(RollOut, LearnsTheArcFromTheFirstMeasurementAfterARestart) {
  RollOut anew;  // a process that starts hears of the base later than it decides
  EXPECT_EQ(stop_until(anew, 0, 200, std::nullopt), geometry::Twist2{});
  EXPECT_EQ(anew.stop(geometry::Twist2{0.8, 0.4}, milliseconds(220)).w, 0.4);
  EXPECT_NEAR(anew.stop(geometry::Twist2{0.4, 0.4}, milliseconds(240)).w, 0.2, 1e-12);
  EXPECT_EQ(anew.stop(geometry::Twist2{0.0, 0.0}, milliseconds(260)), geometry::Twist2{});
}

TEST(RollOut, KeepsTheArcWhereTheClockJumps) {
  RollOut roll_out;
  roll_out.drive({0.8, 0.4}, milliseconds(0));
  EXPECT_EQ(roll_out.stop(std::nullopt, milliseconds(4000)).w, 0.4);
  EXPECT_NEAR(roll_out.stop(geometry::Twist2{0.4, 0.2}, milliseconds(4020)).w, 0.2, 1e-12);
  EXPECT_NEAR(roll_out.stop(geometry::Twist2{0.4, 0.2}, milliseconds(0)).w, 0.2, 1e-12);
}

TEST(RollOut, TakesSwayForStraightOn) {
  RollOut roll_out;
  EXPECT_EQ(roll_out.stop(geometry::Twist2{0.8, -0.02}, milliseconds(0)), geometry::Twist2{});
}

TEST(RollOut, KeepsTheArcBackwards) {
  RollOut roll_out;
  roll_out.stop(geometry::Twist2{-0.4, 0.2}, milliseconds(0));
  EXPECT_NEAR(roll_out.stop(geometry::Twist2{-0.2, 0.0}, milliseconds(200)).w, 0.1, 1e-12);
}

TEST(RollOut, BeginsAnewAfterADrive) {
  RollOut roll_out;
  roll_out.stop(geometry::Twist2{0.8, 0.4}, milliseconds(0));
  roll_out.drive({0.8, -0.3}, milliseconds(8990));
  EXPECT_EQ(roll_out.stop(geometry::Twist2{0.5, -0.2}, milliseconds(9000)).w, -0.2);
}

TEST(RollOut, BelievesNoTurnRateThatTheBaseWasNotTold) {
  const geometry::Twist2 arc{0.8, 0.4}, straight{0.2, 0.0};
  RollOut hangs;
  hangs.drive(arc, milliseconds(0));
  hangs.drive(straight, milliseconds(20));
  EXPECT_EQ(RollOut(hangs).stop(arc, milliseconds(30)).w, 0.4) << "the base follows later";
  for (int ms = 40; ms <= 2000; ms += 20) hangs.drive(straight, milliseconds(ms));
  EXPECT_NEAR(hangs.stop(arc, milliseconds(2020)).w, RollOut::kTurnSlack, 0.01);
  EXPECT_EQ(RollOut().stop(arc, milliseconds(0)).w, 0.4) << "who has just begun was told nothing";
}

TEST(WhiskerReflex, BarsPerCornerAndDirection) {
  struct Row {
    double forward, backward;  ///< [m/s] of 0.5
    Whiskers whiskers;
    bool left, right;  ///< what stays possible
  };
  const Row rows[] = {
      {0.5, 0.5, {false, false, false, false}, true, true},
      {0.0, 0.5, {true, false, false, false}, false, true},
      {0.0, 0.5, {false, true, false, false}, true, false},
      {0.0, 0.5, {true, true, false, false}, false, false},
      {0.5, 0.0, {false, false, true, false}, true, false},
      {0.5, 0.0, {false, false, false, true}, false, true},
      {0.5, 0.0, {false, false, true, true}, false, false},
      {0.0, 0.0, {true, false, false, true}, false, true},
      {0.0, 0.0, {false, true, true, false}, true, false},
      // Beside a wall: creeps along.
      {0.1, 0.1, {true, false, true, false}, false, false},
      {0.0, 0.1, {true, true, true, false}, false, false},
      {0.1, 0.0, {true, false, true, true}, false, false},
      {0.0, 0.0, {true, true, true, true}, false, false},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(whisker_reflex({0.5, 0.0}, row.whiskers, 0.1).v, row.forward);
    EXPECT_EQ(whisker_reflex({-0.5, 0.0}, row.whiskers, 0.1).v, -row.backward);
    EXPECT_EQ(whisker_reflex({0.0, 0.5}, row.whiskers, 0.1).w, row.left ? 0.5 : 0.0);
    EXPECT_EQ(whisker_reflex({0.0, -0.5}, row.whiskers, 0.1).w, row.right ? -0.5 : 0.0);
  }
}

TEST(WhiskerReflex, AnArcWhoseTurnIsBarredIsNotDrivenStraightAtSpeed) {
  const Whiskers back_right{.back_right = true};
  EXPECT_EQ(whisker_reflex({0.5, 0.5}, back_right, 0.1), (geometry::Twist2{0.05, 0.0}));
  EXPECT_EQ(whisker_reflex({0.5, -0.5}, back_right, 0.1), (geometry::Twist2{0.5, -0.5}));
}

TEST(WhiskerReflex, BendsAwayFromWhatStandsBeside) {
  const Whiskers left{.front_left = true, .back_left = true};
  EXPECT_LT(whisker_reflex({0.1, -0.5}, left, 0.1).w, 0.0);
  EXPECT_GE(whisker_reflex({0.1, -0.5}, left, 0.1).w, -0.05);
  EXPECT_EQ(whisker_reflex({0.1, 0.5}, left, 0.1).w, 0.0);
  EXPECT_GT(whisker_reflex({-0.1, 0.5}, left, 0.1).w, 0.0);
  const Whiskers all{true, true, true, true};
  EXPECT_EQ(whisker_reflex({0.1, -0.5}, all, 0.1), geometry::Twist2{});
}

TEST(WhiskerReflex, BarsATurnThatSwingsATouchedCornerOutward) {
  for (const double w : {0.5, 0.0, -0.5}) {
    EXPECT_EQ(bars_turn({.front_left = true}, w), w > 0.0);
    EXPECT_EQ(bars_turn({.back_right = true}, w), w > 0.0);
    EXPECT_EQ(bars_turn({.front_right = true}, w), w < 0.0);
    EXPECT_EQ(bars_turn({.back_left = true}, w), w < 0.0);
    EXPECT_FALSE(bars_turn({}, w));
  }
}

TEST(WhiskerRods, LieAtWhatWasSeenTwiceOrKnownInThreeCells) {
  const WhiskerRods rods(geometry::Footprint::rectangle(0.61, 0.66), {});
  using geometry::Point2;
  const Point2 middle(0.305 + 0.2 * std::cos(geometry::radians(20.0)),
                      0.33 + 0.2 * std::sin(geometry::radians(20.0)));
  const auto at = [&](const std::vector<Point2>& points) {
    const Whiskers is = rods.at_seen(points);
    return std::vector<bool>{is.front_left, is.front_right, is.back_left, is.back_right};
  };
  const std::vector<bool> none(4, false);
  EXPECT_EQ(at({}), none);
  EXPECT_EQ(at({middle}), none) << "may be noise, or the touch's own mark";
  for (int corner = 0; corner < 4; ++corner) {
    const Point2 there(corner / 2 == 0 ? middle.x() : -middle.x(),
                       corner % 2 == 0 ? middle.y() : -middle.y());
    std::vector<bool> one(4, false);
    one[static_cast<std::size_t>(corner)] = true;
    EXPECT_EQ(at({there, there}), one);
    EXPECT_EQ(at({there, 0.95 * there}), one);
    EXPECT_EQ(at({there, {there.x(), 1.4 * there.y()}}), none) << "one beside it";
    const std::vector<Point2> cells(3, there);
    const Whiskers known = rods.at_known(cells);
    EXPECT_EQ(
        (std::vector<bool>{known.front_left, known.front_right, known.back_left, known.back_right}),
        one);
    EXPECT_FALSE(any(rods.at_known(std::span(cells).first(2)))) << "a touch's own marks";
  }
  EXPECT_EQ(at({{0.6, 0.3}, {0.6, 0.31}}), none) << "ahead of the robot, beside the whisker";
  EXPECT_EQ(at({{0.0, 0.34}, {0.01, 0.34}}), none) << "beside the robot";
  EXPECT_EQ(at({{kNaN, 0.4}, {0.4, kNaN}, {kInfinity, 0.4}}), none);
  EXPECT_GT(rods.reach(), middle.norm() + 0.2);
  EXPECT_LT(rods.reach(), 1.0);
}

}  // namespace
}  // namespace usher::kinematics
