#include "foundation/geometry/swept_outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/random/random.hpp"

namespace usher::geometry {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Longer behind the axle than before it.
Footprint outline() {
  const Point2 corners[] = {{0.3, -0.25}, {0.3, 0.25}, {-0.4, 0.25}, {-0.4, -0.25}};
  return Footprint::make(corners).value();
}

double contact(const Twist2& twist, const Point2& point) {
  return SweptOutline(outline(), twist).contact(point);
}

TEST(SweptOutline, MeetsWhatIsStraightAhead) {
  EXPECT_NEAR(contact({0.5, 0.0}, {1.3, 0.2}), 2.0, 1e-12);
  EXPECT_EQ(contact({0.5, 0.0}, {1.3, 0.26}), kNever) << "beside the way";
  EXPECT_EQ(contact({-0.5, 0.0}, {1.3, 0.2}), kNever) << "behind its back";
  EXPECT_NEAR(contact({-0.5, 0.0}, {-1.4, 0.0}), 2.0, 1e-12);
}

TEST(SweptOutline, SwingsItsCornersWhenItTurnsOnTheSpot) {
  const double back = std::hypot(0.4, 0.25), front = std::hypot(0.3, 0.25);
  // Turning right, the back left corner swings out to the left.
  EXPECT_NEAR(contact({0.0, -0.5}, {back * std::cos(2.3), (back - 1e-6) * std::sin(2.3)}),
              (std::atan2(0.25, -0.4) - 2.3) / 0.5, 0.01);
  EXPECT_EQ(contact({0.0, 0.5}, {0.0, 0.48}), kNever) << "beyond all corners";
  EXPECT_NEAR(contact({0.0, 0.5}, {front * std::cos(1.2), front * std::sin(1.2) - 1e-6}),
              (1.2 - std::atan2(0.25, 0.3)) / 0.5, 0.01)
      << "turning left, the front left corner meets it";
}

TEST(SweptOutline, SlidesAlongWhatItTouchesAndAway) {
  const Point2 beside{0.1, 0.24}, before{0.29, 0.0};
  EXPECT_EQ(contact({0.5, 0.0}, beside), kNever);
  EXPECT_EQ(contact({0.5, 0.2}, beside), 0.0) << "the front swings into it";
  EXPECT_EQ(contact({0.5, 0.0}, before), 0.0);
  EXPECT_EQ(contact({-0.5, 0.0}, before), kNever);
}

TEST(SweptOutline, ZeroAndNonsenseMeetNothing) {
  EXPECT_EQ(contact({}, {0.3, 0.0}), kNever);
  EXPECT_EQ(contact({std::nan(""), 1.0}, {0.5, 0.0}), kNever);
}

TEST(SweptOutline, AgreesWithSmallSteps) {
  Random random(5);
  const Footprint robot = outline();
  int met = 0;
  for (int i = 0; i < 1000; ++i) {
    const Twist2 twist{random.uniform(-1.0, 1.0), i % 3 == 0 ? 0.0 : random.uniform(-1.5, 1.5)};
    const Point2 point{random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2)};
    if (robot.distance(point) < 0.01) continue;
    const double told = SweptOutline(robot, twist).contact(point);
    constexpr double kStep = 1e-3, kLongest = 4.0;
    double found = kNever;
    for (double t = 0.0; t < kLongest && found == kNever; t += kStep) {
      if (robot.distance(inverse(integrate({}, twist, t)) * point) <= 1e-4) found = t;
    }
    if (told < kLongest - 0.1) {
      ++met;
      // A corner may graze a point so shortly that a step jumps over it.
      const double before = robot.distance(inverse(integrate({}, twist, told)) * point);
      EXPECT_LT(before, 1e-6) << i;
      EXPECT_GE(found, told - 5e-3) << i;
    } else {
      EXPECT_GE(found, kLongest - 0.2)
          << i << ": " << twist.v << " " << twist.w << " at " << point.x() << " " << point.y();
    }
  }
  EXPECT_GT(met, 90);
}

}  // namespace
}  // namespace usher::geometry
