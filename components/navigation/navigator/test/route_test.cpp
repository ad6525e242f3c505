#include "navigation/navigator/core/route.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::navigator {
namespace {

std::vector<geometry::Pose2> straight(double length, double spacing) {
  std::vector<geometry::Pose2> path;
  for (int i = 0; i <= static_cast<int>(std::lround(length / spacing)); ++i)
    path.push_back({i * spacing, 0.0, 0.0});
  return path;
}

TEST(Route, MeasuresWhatIsLeftAndHowFarOff) {
  Route route;
  route.set(straight(10.0, 0.05));
  EXPECT_NEAR(route.length(), 10.0, 1e-9);
  EXPECT_NEAR(route.track({2.52, 0.3, 0.0}), 2.52, 1e-9);
  EXPECT_NEAR(route.remaining(), 7.48, 1e-9);
  EXPECT_NEAR(route.offset(), 0.3, 1e-9);
  EXPECT_NEAR(route.track({2.4, -0.1, 0.0}), -0.12, 1e-9);
  EXPECT_NEAR(route.track({12.0, 0.0, 0.0}), 7.6, 1e-9);
  EXPECT_NEAR(route.remaining(), 0.0, 1e-9);
  EXPECT_NEAR(route.offset(), 2.0, 1e-9);
}

TEST(Route, KnowsHowMuchTheRobotHasStillToTurn) {
  std::vector<geometry::Pose2> path = straight(4.0, 0.05);
  for (int i = 1; i <= 60; ++i) path.push_back({4.0, i * 0.05, 0.0});
  path.back().yaw = 0.0;
  const double quarter = geometry::kPi / 2;
  Route route;
  route.set(path);
  EXPECT_NEAR(route.turning_left(0.0), 2 * quarter, 1e-6) << "the corner, and back at the end";
  EXPECT_NEAR(route.turning_left(geometry::kPi), 4 * quarter, 1e-6) << "to the path";
  route.track({4.0, 0.5, 0.0});
  EXPECT_NEAR(route.turning_left(quarter), quarter, 1e-6);
  route.track({4.0, 3.0, 0.0});
  EXPECT_NEAR(route.turning_left(0.3), 0.3, 1e-6);
  route.set({{1.0, 1.0, 0.5}});
  EXPECT_NEAR(route.turning_left(0.0), 0.5, 1e-9);
}

TEST(Route, TheStepsOfAGridAreNoTurns) {
  std::vector<geometry::Pose2> path;
  path.reserve(100);
  for (int i = 0; i < 100; ++i) path.push_back({i * 0.05, i % 2 * 0.05, 0.0});
  Route route;
  route.set(path);
  EXPECT_LT(route.turning_left(0.0), 2.0);
}

TEST(Route, IsNotCutShortWhereItCrossesItself) {
  // 4 m out and back again beside itself.
  std::vector<geometry::Pose2> path = straight(4.0, 0.1);
  for (int i = 40; i >= 0; --i) path.push_back({i * 0.1, 0.2, 3.14});
  Route route;
  route.set(path);
  route.track({0.5, 0.11, 0.0});
  EXPECT_NEAR(route.remaining(), route.length() - 0.5, 1e-9);
}

TEST(Route, FindsTheRobotAgainAfterAJump) {
  Route route;
  route.set(straight(20.0, 0.05));
  route.track({15.0, 0.1, 0.0});
  EXPECT_NEAR(route.remaining(), 5.0, 1e-9);
}

TEST(Route, OfOnePoseIsAtItsEnd) {
  Route route;
  EXPECT_TRUE(route.empty());
  EXPECT_EQ(route.remaining(), 0.0);
  route.set({{1.0, 1.0, 0.5}});
  EXPECT_EQ(route.track({1.0, 2.0, 0.0}), 0.0);
  EXPECT_EQ(route.remaining(), 0.0);
  EXPECT_NEAR(route.offset(), 1.0, 1e-12);
}

TEST(Route, KnowsHowFarFromTheNextMetresAPointIs) {
  Route route;
  route.set(straight(10.0, 0.05));
  route.track({2.0, 0.1, 0.0});
  EXPECT_NEAR(route.distance_ahead({3.0, -0.4}, 3.0), 0.4, 1e-9);
  EXPECT_NEAR(route.distance_ahead({1.5, 0.0}, 3.0), 0.5, 1e-9) << "behind the robot";
  EXPECT_NEAR(route.distance_ahead({6.0, 0.0}, 3.0), 1.0, 0.051) << "a segment's length";
  route.track({9.9, 0.0, 0.0});
  EXPECT_NEAR(route.distance_ahead({10.3, 0.0}, 3.0), 0.3, 1e-9) << "beyond the end";
}

TEST(Route, TakesDoubledPoses) {
  Route route;
  route.set({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  EXPECT_NEAR(route.track({0.5, 0.0, 0.0}), 0.5, 1e-12);
  EXPECT_NEAR(route.remaining(), 0.5, 1e-12);
}

}  // namespace
}  // namespace usher::navigator
