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
  return Guard(parameters).share(twist, {points, true}, twist);
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
    told.push_back(0.8 * guard.share({0.0, 0.8}, {seen, true}, Twist2{0.0, rate}));
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
  const double into = 0.8 * Guard(marvin()).share({0.8, 0.05}, {near, true}, Twist2{});
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

TEST(Guard, TellsTheWayAlongTheArc) {
  const Guard guard(marvin());
  const auto ahead = wall({2.0, -3.0}, {2.0, 3.0});
  EXPECT_NEAR(guard.way({0.5, 0.0}, ahead), 1.695, 1e-9);
  EXPECT_NEAR(guard.way({0.0, 0.0}, ahead), 1.695, 1e-9) << "standing";
  EXPECT_NEAR(guard.way({0.0, 0.7}, ahead), 1.695, 1e-9) << "turning";
  EXPECT_GT(guard.way({0.5, 0.25}, ahead), 1.7);
  EXPECT_EQ(guard.way({0.5, 0.5}, ahead), std::numeric_limits<double>::infinity())
      << "the turn is tighter than the room";
  EXPECT_EQ(guard.way({-0.5, 0.0}, ahead), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace usher::movement_control
