#include "control/movement_control/core/guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "foundation/geometry/angle.hpp"

namespace usher::movement_control {
namespace {

using geometry::Point2;
using geometry::Twist2;

/// Points of a straight wall, a millimetre apart.
std::vector<Point2> wall(const Point2& from, const Point2& to) {
  std::vector<Point2> points;
  const double length = (to - from).norm();
  const auto count = static_cast<int>(1000.0 * length);
  points.reserve(static_cast<std::size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) points.push_back(from + (to - from) * (i / (1000.0 * length)));
  return points;
}

Guard::Parameters marvin() { return {}; }

Guard::Parameters pioneer() {
  Guard::Parameters p;
  p.outline = geometry::Footprint::rectangle(0.456, 0.382);
  p.turn_stop = 0.17;
  return p;
}

double share(const Guard::Parameters& parameters, const Twist2& twist,
             const std::vector<Point2>& points) {
  return Guard(parameters).share(twist, {.points = points, .sees = true}, twist);
}

TEST(Guard, DrivesNoFasterThanItStopsBeforeAWall) {
  const kinematics::StoppingDistance stopping;
  const auto speed = [&](double x, double v) {
    return v * share(marvin(), {v, 0.0}, wall({x, -1.0}, {x, 1.0}));
  };
  EXPECT_EQ(speed(4.0, 0.8), 0.8) << "far away";
  // 1 m from the outline and its margin, 0.8 m/s for the reaction of 0.7 s.
  EXPECT_NEAR(speed(1.325, 0.8), stopping.speed(1.0 - 0.56), 1e-9);
  EXPECT_NEAR(speed(0.45, 0.8), 0.0, 1e-9) << "at 0.8 m/s it would be too late";
  EXPECT_NEAR(speed(0.40, 0.1), (0.085 - 0.07) / 1.48, 1e-9) << "half of the margin";
  EXPECT_EQ(speed(0.30, 0.1), 0.0) << "it touches";
  EXPECT_EQ(share(marvin(), {-0.4, 0.0}, wall({0.31, -1.0}, {0.31, 1.0})), 1.0) << "backwards";
}

TEST(Guard, KeepsTheArcAndLooksAlongIt) {
  const auto beside = wall({-2.0, 0.8}, {4.0, 0.8});
  EXPECT_EQ(share(marvin(), {0.8, 0.0}, beside), 1.0);
  const double left = share(marvin(), {0.8, 0.8}, beside);
  EXPECT_GT(left, 0.0);
  EXPECT_LT(left, 0.8);
  EXPECT_EQ(share(marvin(), {0.8, -0.8}, beside), 1.0) << "away from it";
}

TEST(Guard, OnePointAloneIsNoise) {
  std::vector<Point2> points{{0.8, 0.0}};
  EXPECT_EQ(share(marvin(), {0.8, 0.0}, points), 1.0);
  points.emplace_back(0.8, 0.05);
  EXPECT_LT(share(marvin(), {0.8, 0.0}, points), 0.4);
}

TEST(Guard, TurnsNoCornerIntoAWall) {
  // 0.24 m beside a robot of 0.191 m, whose corners swing out to 0.297 m. Seen before the axle
  // only.
  const auto right = wall({0.0, -0.24}, {3.0, -0.24});
  EXPECT_LT(share(pioneer(), {0.0, -0.8}, right), 1.0);
  EXPECT_EQ(share(pioneer(), {0.0, 0.8}, right), 1.0);
  const auto whole = wall({-3.0, -0.24}, {3.0, -0.24});
  EXPECT_LT(share(pioneer(), {0.0, 0.8}, whole), 1.0) << "the corner behind";
  // A bar just before the corner: no turn to that side.
  EXPECT_EQ(share(pioneer(), {0.0, 0.8}, wall({0.18, 0.20}, {0.2, 0.25})), 0.0);
  EXPECT_EQ(share(pioneer(), {0.0, -0.8}, wall({0.18, 0.20}, {0.2, 0.25})), 1.0);
  EXPECT_EQ(share(pioneer(), {0.0, 0.8}, wall({-3.0, 0.31}, {3.0, 0.31})), 1.0) << "room enough";
}

TEST(Guard, TurningIntoSomethingItComesToRestBeforeIt) {
  // First-order lag and dead time of MARVIN's turn, a wall beside it.
  const Guard guard(marvin());
  double yaw = 0.0, rate = 0.0;
  std::vector<double> told(10, 0.0);  // 0.1 s
  for (int i = 0; i < 400; ++i) {
    std::vector<Point2> seen;
    for (const Point2& p : wall({-2.0, 0.4}, {2.0, 0.4}))
      seen.push_back(geometry::inverse({0.0, 0.0, yaw}) * p);
    told.push_back(0.8 *
                   guard.share({0.0, 0.8}, {.points = seen, .sees = true}, Twist2{0.0, rate}));
    rate += (told[told.size() - 11] - rate) * 0.01 / 0.2;
    yaw += rate * 0.01;
  }
  // The front left corner, at 47 deg and 0.449 m, meets the wall at 63 deg.
  const double contact = std::asin(0.4 / std::hypot(0.305, 0.33)) - std::atan2(0.33, 0.305);
  EXPECT_LT(yaw, contact);
  EXPECT_GT(yaw, 0.5 * contact);
}

TEST(Guard, WithinTheMarginItCreeps) {
  const auto near = wall({-1.0, 0.345}, {1.0, 0.345});  // 15 mm beside MARVIN
  EXPECT_NEAR(0.8 * share(marvin(), {0.8, 0.0}, near), 0.05, 1e-9) << "along it";
  const double into =
      0.8 * Guard(marvin()).share({0.8, 0.05}, {.points = near, .sees = true}, Twist2{});
  EXPECT_LE(into, 0.05);
  EXPECT_GT(into, 0.0);
  EXPECT_EQ(share(marvin(), {0.8, 0.0}, wall({-1.0, 0.36}, {1.0, 0.36})), 1.0);
}

TEST(Guard, WithoutAScanItCreeps) {
  const Guard guard(marvin());
  EXPECT_NEAR(0.8 * guard.share({0.8, 0.0}, {}, Twist2{}), 0.1, 1e-12);
  EXPECT_NEAR(0.8 * guard.share({0.0, 0.8}, {}, Twist2{}) * std::hypot(0.305, 0.33), 0.1, 1e-12)
      << "of its corners";
  EXPECT_EQ(guard.share({0.05, 0.0}, {}, Twist2{}), 1.0);
}

double planned(const Twist2& twist, const Guard::View& view) {
  return Guard(marvin()).planned_share(twist, view, twist);
}

TEST(Guard, LeavesAPlannerAloneThatCanStop) {
  const auto speed = [&](double x) {
    return 0.8 * planned({0.8, 0.0}, {.points = wall({x, -1.0}, {x, 1.0}), .sees = true});
  };
  // 1.184 m after the outline and the stand-off.
  EXPECT_EQ(speed(0.305 + 0.08 + 1.19), 0.8);
  EXPECT_NEAR(speed(0.305 + 0.08 + 1.18), (1.18 - 0.56) / 1.48, 1e-9) << "as an operator";
  EXPECT_EQ(speed(0.305 + 0.08 + 0.70), 0.0) << "0.09 m/s: it would creep up to it";
  const auto near = wall({0.305 + 0.08 + 0.15, -1.0}, {0.305 + 0.08 + 0.15, 1.0});
  EXPECT_EQ(planned({0.1, 0.0}, {.points = near, .sees = true}), 1.0) << "who wants no more may";
  EXPECT_EQ(speed(0.305 + 0.07), 0.0);
  EXPECT_EQ(speed(0.2), 0.0) << "it touches";
  const auto beside = wall({-2.0, 0.331}, {4.0, 0.331});
  EXPECT_EQ(planned({0.8, 0.0}, {.points = beside, .sees = true}), 1.0);
  EXPECT_EQ(planned({-0.15, 0.0}, {.points = beside, .sees = true}), 1.0);
  EXPECT_LT(planned({0.8, 0.1}, {.points = beside, .sees = true}), 1.0) << "into it";
  EXPECT_EQ(planned({0.8, 0.0}, {}), 1.0) << "without a scan it is the planner that stands";
}

TEST(Guard, DoesNotHoldBackAPlannerForWhatNobodyHasSeen) {
  const auto corner = wall({0.0, 0.4}, {-0.6, 0.4});
  const Guard::View seen{.points = corner, .sees = true};
  const Guard::View guessed{.points = corner, .sees = true, .guessed = corner.size()};
  EXPECT_LT(planned({0.0, -1.0}, seen), 1.0);
  EXPECT_EQ(planned({0.0, -1.0}, guessed), 1.0);
  EXPECT_LT(share(marvin(), {0.0, -1.0}, corner), 1.0) << "an operator it does";
}

TEST(Guard, HoldsBackAPlannersTurnOnTheSpotButNotOneThatRollsOut) {
  const auto beside = wall({-2.0, 0.4}, {2.0, 0.4});  // 0.27 rad
  const Guard guard(marvin());
  const auto turn = [&](double w, double v) {
    return guard.planned_share({0.0, w}, {.points = beside, .sees = true}, Twist2{v, w});
  };
  EXPECT_EQ(turn(0.5, 0.0), 1.0);
  EXPECT_LT(turn(1.0, 0.0), 1.0);
  EXPECT_EQ(turn(1.0, 0.5), 1.0) << "told to stand, it keeps its arc";
}

TEST(Guard, LethalCellsCountForEverybodyWithTheBareOutlineAndAStandOff) {
  const auto ahead = wall({1.325, -1.0}, {1.325, 1.0});
  const Guard guard(marvin());
  const auto operated = [&](const Twist2& twist, const std::vector<Point2>& cells) {
    return guard.share(twist, {.sees = true, .cells = cells}, twist);
  };
  EXPECT_NEAR(0.8 * operated({0.8, 0.0}, ahead), (1.02 - 0.08 - 0.56) / 1.48, 1e-9);
  EXPECT_NEAR(0.8 * planned({0.8, 0.0}, {.sees = true, .cells = ahead}),
              (1.02 - 0.08 - 0.56) / 1.48, 1e-9);
  EXPECT_EQ(operated({0.1, 0.0}, wall({0.37, -1.0}, {0.37, 1.0})), 0.0) << "no creeping there";
  EXPECT_EQ(operated({0.8, 0.0}, wall({-2.0, 0.331}, {4.0, 0.331})), 1.0);
  EXPECT_EQ(operated({0.8, 0.0}, {{0.8, 0.0}}), 1.0) << "one echo alone may have made it";
  // Turning, the corners keep the stand-off.
  const auto beside = wall({-2.0, 0.4}, {2.0, 0.4});
  EXPECT_LT(operated({0.0, 0.3}, beside), share(marvin(), {0.0, 0.3}, beside));
}

TEST(Guard, ReachesAsFarAsSomethingBears) {
  const Guard guard(marvin());
  for (const double v : {0.1, 0.5, 0.9, 1.4}) {
    const double far = guard.reach(v);
    const Twist2 twist{v, 0.2};
    EXPECT_EQ(guard.share(twist, {.sees = true, .cells = wall({far, -1.0}, {far, 1.0})}, twist),
              1.0);
    const double near = far - 0.2;
    EXPECT_LT(guard.share(twist, {.sees = true, .cells = wall({near, -1.0}, {near, 1.0})}, twist),
              1.0);
  }
}

TEST(Guard, TellsTheWayAlongTheArc) {
  const Guard guard(marvin());
  const auto ahead = wall({2.0, -3.0}, {2.0, 3.0});
  const auto way = [&](const Twist2& twist) {
    const double seen = guard.way(twist, {.points = ahead, .sees = true});
    EXPECT_EQ(seen, guard.way(twist, {.sees = true, .cells = ahead}));
    return seen;
  };
  EXPECT_NEAR(way({0.5, 0.0}), 1.695, 1e-9);
  EXPECT_NEAR(way({0.0, 0.0}), 1.695, 1e-9) << "standing";
  EXPECT_NEAR(way({0.0, 0.7}), 1.695, 1e-9) << "turning";
  EXPECT_GT(way({0.5, 0.25}), 1.7);
  EXPECT_EQ(way({0.5, 0.5}), std::numeric_limits<double>::infinity())
      << "the turn is tighter than the room";
  EXPECT_EQ(way({-0.5, 0.0}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace usher::movement_control
