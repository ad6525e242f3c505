#include "tasks/meeting/core/cleared_space.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace usher::meeting {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// 4 x 4 m.
ClearedSpace room() {
  ClearedSpace space;
  space.set_extent(grid::GridGeometry{80, 80, 0.05, -1.0, -1.0});
  return space;
}
/// A fan of beams that end 2 m ahead.
std::vector<Point2> wall() {
  std::vector<Point2> points;
  for (int i = -30; i <= 30; ++i) points.emplace_back(2.0, 0.02 * i);
  return points;
}

TEST(ClearedSpace, IsWhereThreeScansLookedThrough) {
  ClearedSpace space = room();
  EXPECT_FALSE(space.was_clear({1.0, 0.0}));
  space.add({0.0, 0.0}, wall());
  space.add({0.0, 0.0}, wall());
  EXPECT_FALSE(space.was_clear({1.0, 0.0})) << "twice may be noise";
  space.add({0.0, 0.0}, wall());
  EXPECT_TRUE(space.was_clear({1.0, 0.0}));
  EXPECT_FALSE(space.was_clear({1.9, 0.0})) << "the wall and what belongs to it";
  EXPECT_FALSE(space.was_clear({1.0, 0.6})) << "beside the fan";
  EXPECT_FALSE(space.was_clear({-0.5, 0.0})) << "behind";
  space.forget();
  EXPECT_FALSE(space.was_clear({1.0, 0.0}));
}

TEST(ClearedSpace, IsTakenWhereThreePointsLay) {
  ClearedSpace space = room();
  const std::vector<Point2> legs{{1.5, 0.0}};
  space.add({0.0, 0.0}, legs);
  space.add({0.0, 0.0}, legs);
  EXPECT_FALSE(space.was_taken({1.6, 0.1})) << "twice may be noise";
  space.add({0.0, 0.0}, legs);
  EXPECT_TRUE(space.was_taken({1.6, 0.1}));
  EXPECT_FALSE(space.was_taken({1.0, 0.0}));
  EXPECT_FALSE(space.was_taken({kNan, 0.0}));
  space.forget();
  EXPECT_FALSE(space.was_taken({1.6, 0.1}));
}

TEST(ClearedSpace, IsNoWallThatFewBeamsMissed) {
  ClearedSpace space = room();
  std::vector<Point2> beyond;
  for (const Point2& point : wall()) beyond.emplace_back(1.4 * point);
  for (int i = 0; i < 100; ++i) space.add({0.0, 0.0}, wall());
  for (int i = 0; i < 5; ++i) space.add({0.0, 0.0}, beyond);
  EXPECT_FALSE(space.was_clear({2.0, 0.0}));
  EXPECT_TRUE(space.was_clear({1.0, 0.0}));
}

TEST(ClearedSpace, BadInputIsNothing) {
  ClearedSpace nowhere;
  nowhere.add({0.0, 0.0}, wall());
  EXPECT_FALSE(nowhere.was_clear({1.0, 0.0})) << "without a map";
  ClearedSpace space = room();
  std::vector<Point2> bad{{kNan, 0.0}, {1e300, 1e300}, {0.0, 0.0}};
  for (int i = 0; i < 180; ++i) bad.emplace_back(50.0, 20.0 + 0.5 * i);
  for (int i = 0; i < 3; ++i) space.add({0.0, 0.0}, bad);
  space.add({kNan, 0.0}, wall());
  EXPECT_TRUE(space.was_clear({0.7, 0.7})) << "on the way to what lies outside";
  EXPECT_FALSE(space.was_clear({kNan, 1.0}));
  EXPECT_FALSE(space.was_clear({1e300, 1.0}));
}

}  // namespace
}  // namespace usher::meeting
