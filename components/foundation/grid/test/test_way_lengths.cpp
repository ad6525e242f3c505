#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "foundation/grid/way_lengths.hpp"

namespace usher::grid {
namespace {

/// 4 x 4 m, free, with a wall at x = 2 m that leaves a gap of 1 m at the top.
OccupancyGrid divided() {
  OccupancyGrid map(GridGeometry{80, 80, 0.05, 0.0, 0.0}, kFree);
  for (int y = 0; y < 60; ++y) map.at({40, y}) = kOccupied;
  return map;
}

TEST(WayLengths, GoRoundWalls) {
  WayLengths ways;
  EXPECT_TRUE(ways.empty());
  ASSERT_TRUE(ways.set_map(divided(), 0.2).ok());
  ASSERT_TRUE(ways.start_from({1.0, 1.0}));
  EXPECT_NEAR(ways.way_to({1.0, 2.0}), 1.0, 0.1);
  const double round = ways.way_to({3.0, 1.0});
  EXPECT_GT(round, 4.5) << "over the top of the wall, not through it";
  EXPECT_LT(round, 5.6);
  std::vector<Point2> way;
  ways.trace({3.0, 1.0}, way);
  ASSERT_GT(way.size(), 20U);
  EXPECT_LT((way.front() - Point2(1.0, 1.0)).norm(), 0.1);
  EXPECT_LT((way.back() - Point2(3.0, 1.0)).norm(), 0.1);
}

TEST(WayLengths, AreInfiniteWhereThereIsNoWay) {
  OccupancyGrid map = divided();
  for (int y = 60; y < 80; ++y) map.at({40, y}) = kOccupied;
  WayLengths ways;
  ASSERT_TRUE(ways.set_map(map, 0.2).ok());
  ASSERT_TRUE(ways.start_from({1.0, 1.0}));
  const double none = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ways.way_to({3.0, 1.0}), none);
  EXPECT_EQ(ways.way_to({100.0, 1.0}), none);
  EXPECT_EQ(ways.way_to({nan, 1.0}), none);
  EXPECT_EQ(ways.way_to({1e300, 1.0}), none);
  EXPECT_FALSE(ways.start_from({nan, 1.0}));
  EXPECT_FALSE(ways.start_from({1e9, 1.0}));
  EXPECT_EQ(ways.way_to({1.0, 1.0}), none) << "measured from nowhere";
}

TEST(WayLengths, AreMeasuredOnLargerCellsInALargeMap) {
  OccupancyGrid map(GridGeometry{3900, 100, 0.05, -10.0, 0.0}, kFree);
  for (int y = 0; y < 80; ++y) map.at({2001, y}) = kOccupied;  // a wall of one cell
  for (int y = 0; y < 100; ++y) map.at({3601, y}) = kUnknown;
  WayLengths ways;
  ASSERT_TRUE(ways.set_map(map, 0.2).ok());
  ASSERT_TRUE(ways.start_from({85.0, 1.0}));
  EXPECT_NEAR(ways.way_to({70.0, 1.0}), 15.0, 1.2);
  EXPECT_GT(ways.way_to({95.0, 1.0}), 11.0) << "over the top of the wall, not through it";
  EXPECT_LT(ways.way_to({95.0, 1.0}), 14.0);
  EXPECT_TRUE(std::isinf(ways.way_to({175.0, 1.0}))) << "beyond what nobody has seen";
}

TEST(WayLengths, RefuseAMapThatIsNoneAndKeepTheOneTheyHave) {
  WayLengths ways;
  EXPECT_FALSE(ways.set_map({}, 0.2).ok());
  ASSERT_TRUE(ways.set_map(divided(), 0.2).ok());
  EXPECT_FALSE(ways.set_map(OccupancyGrid(GridGeometry{4001, 2, 0.05, 0, 0}, kFree), 0.2).ok());
  EXPECT_TRUE(ways.start_from({1.0, 1.0}));
}

}  // namespace
}  // namespace usher::grid
