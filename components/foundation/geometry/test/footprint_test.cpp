#include "foundation/geometry/footprint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace usher::geometry {
namespace {

std::vector<Point2> regular(int corners, double radius) {
  std::vector<Point2> points;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * kPi * i / corners;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return points;
}

TEST(Footprint, KnowsItsRadii) {
  const Footprint square = Footprint::rectangle(0.6, 0.8);
  EXPECT_NEAR(square.inscribed_radius(), 0.3, 1e-12);
  EXPECT_NEAR(square.circumscribed_radius(), 0.5, 1e-12);
}

TEST(Footprint, KnowsHowFarItReachesToItsSides) {
  EXPECT_NEAR(Footprint::rectangle(0.6, 0.8).half_width(), 0.4, 1e-12);
  const std::vector<Point2> lopsided{{0.3, 0.2}, {-0.3, 0.2}, {-0.3, -0.5}, {0.3, -0.4}};
  EXPECT_NEAR(Footprint::make(lopsided).value().half_width(), 0.5, 1e-12);
}

TEST(Footprint, AcceptsEitherSense) {
  std::vector<Point2> corners = regular(5, 0.4);
  const Footprint one = Footprint::make(corners).value();
  std::reverse(corners.begin(), corners.end());
  const Footprint other = Footprint::make(corners).value();
  EXPECT_NEAR(one.inscribed_radius(), other.inscribed_radius(), 1e-12);
}

TEST(Footprint, DistanceIsZeroInsideAndEuclideanOutside) {
  const Footprint square = Footprint::rectangle(0.6, 0.8);
  EXPECT_EQ(square.distance({0.1, 0.1}), 0.0);
  EXPECT_NEAR(square.distance({1.3, 0.0}), 1.0, 1e-12);
  EXPECT_NEAR(square.distance({0.6, 0.8}), 0.5, 1e-12);
}

TEST(Footprint, GrowsOnEverySide) {
  const Footprint grown = Footprint::rectangle(0.6, 0.8).grown(0.05);
  EXPECT_NEAR(grown.inscribed_radius(), 0.35, 1e-12);
  EXPECT_NEAR(grown.circumscribed_radius(), std::hypot(0.35, 0.45), 1e-12);
}

TEST(Footprint, RefusesWhatIsNotAConvexOutlineAroundTheBase) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::vector<Point2>> wrong{
      {},
      {{1, 0}, {0, 1}},
      {{1, 0}, {0, 1}, {nan, 0}},
      {{1, 0}, {1, 1}, {0.2, 0.2}, {-1, 1}, {-1, -1}, {1, -1}},        // a notch
      {{2, 0}, {3, 0}, {3, 1}, {2, 1}},                                // beside the base
      {{1, 1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}},                    // a corner twice
      {{1, 0}, {-0.8, 0.6}, {0.3, -0.95}, {0.3, 0.95}, {-0.8, -0.6}},  // a star
      std::vector<Point2>(65, Point2{1, 0})};
  for (const auto& corners : wrong) EXPECT_FALSE(Footprint::make(corners).ok());
  EXPECT_NE(Footprint::make(wrong[3]).error().find("convex"), std::string::npos);
}

}  // namespace
}  // namespace usher::geometry
