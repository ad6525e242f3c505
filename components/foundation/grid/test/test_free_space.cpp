#include "foundation/grid/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/grid/test/rooms.hpp"

namespace usher::grid {
namespace {

/// By the definition, cell by cell.
bool blocked_by_definition(const OccupancyGrid& map, Cell c, double inflation) {
  if (map.at(c) < 0) return true;
  const int reach = static_cast<int>(inflation / map.resolution()) + 1;
  for (int y = c.y - reach; y <= c.y + reach; ++y) {
    for (int x = c.x - reach; x <= c.x + reach; ++x) {
      if (map.value_or({x, y}, kFree) == kOccupied &&
          std::hypot(x - c.x, y - c.y) * map.resolution() <= inflation + 1e-9)
        return true;
    }
  }
  return false;
}

TEST(FreeSpace, GrowsObstaclesByADiscAndTheUnknownNotAtAll) {
  auto map = clutter(1);
  for (int i = 0; i < 30; ++i) map.at({100 + i, 100}) = kUnknown;
  FreeSpace space;
  space.build(map, 0.24);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto cell = map.geometry().cell(i);
    ASSERT_EQ(space.free(cell), !blocked_by_definition(map, cell, 0.24)) << cell.x << " " << cell.y;
    ASSERT_EQ(space.free(cell), space.free_at(i));
  }
}

TEST(FreeSpace, ALineIsFreeExactlyWhenAllItsCellsAre) {
  const auto map = clutter(2);
  FreeSpace space;
  space.build(map, 0.24);
  Random random(3);
  int free_lines = 0;
  for (int i = 0; i < 20000; ++i) {
    const Point2 a(random.uniform(-1, 21), random.uniform(-1, 11));
    const double length = random.uniform(0, i % 2 == 0 ? 2 : 20), angle = random.uniform(-4, 4);
    const Point2 b = a + length * Point2(std::cos(angle), std::sin(angle));
    // Points a hundredth of a cell apart: only slivers can slip between them.
    bool free = true;
    for (double s = 0.0; free && s <= length; s += 0.0005)
      free = space.free(Point2(a + (b - a) * (s / std::max(length, 1e-9))));
    if (free) free = space.free(b);
    if (space.line_free(a, b)) {
      ASSERT_TRUE(free) << a.transpose() << " to " << b.transpose();
      ++free_lines;
    } else {
      // A line through the sliver of a blocked cell is not free, whatever the points say.
      ASSERT_TRUE(!free || !space.line_free(b, a));
    }
  }
  EXPECT_GT(free_lines, 1000);
}

TEST(FreeSpace, RefusesWhatIsNotFinite) {
  FreeSpace space;
  space.build(hall(), 0.24);
  const double bad[] = {std::nan(""), INFINITY, -1e300};
  for (const double value : bad) {
    EXPECT_FALSE(space.line_free({5, 5}, {value, 5}));
    EXPECT_FALSE(space.line_free({value, 5}, {5, 5}));
  }
}

TEST(FreeSpace, FindsTheNearestFreePoint) {
  FreeSpace space;
  space.build(hall(), 0.24);
  EXPECT_EQ(*space.nearest_free({5.0, 5.0}, 0.4), Point2(5.0, 5.0));
  const auto moved = space.nearest_free({5.0, 0.1}, 0.4);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(moved->y(), 0.325, 0.051);
  EXPECT_FALSE(space.nearest_free({5.0, 0.1}, 0.05));
}

}  // namespace
}  // namespace usher::grid
