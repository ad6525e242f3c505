#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/ray_cast.hpp"
#include "foundation/random/random.hpp"

namespace usher::grid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

OccupancyGrid with_occupied(const GridGeometry& geometry, const std::vector<Cell>& cells) {
  OccupancyGrid grid(geometry, kFree);
  for (const Cell cell : cells) grid.at(cell) = kOccupied;
  return grid;
}

auto occupied_in(const OccupancyGrid& grid) {
  return [&grid](Cell cell) { return grid.at(cell) == kOccupied; };
}

OccupancyGrid random_grid(std::uint64_t seed, int width, int height, double share) {
  Random random(seed);
  OccupancyGrid grid({width, height, 0.05, -3.0, 2.0}, kFree);
  for (auto& cell : grid) {
    if (random.uniform() < share) cell = kOccupied;
  }
  return grid;
}

TEST(CastRay, EndsWhereItEntersTheBlockingCell) {
  const OccupancyGrid grid = with_occupied({10, 3, 0.5, 1.0, -1.0}, {{7, 1}});
  const auto hit = cast_ray(grid.geometry(), {1.2, -0.25}, 0.0, 10.0, occupied_in(grid));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->range, 1.0 + 7 * 0.5 - 1.2, 1e-12);
  EXPECT_EQ(hit->cell, (Cell{7, 1}));
}

TEST(CastRay, WorksAgainstBothAxes) {
  const OccupancyGrid grid = with_occupied({9, 9, 1.0, 0.0, 0.0}, {{0, 4}, {4, 0}, {4, 8}});
  EXPECT_NEAR(cast_ray(grid.geometry(), {4.5, 4.5}, geometry::kPi, 9, occupied_in(grid))->range,
              3.5, 1e-12);
  EXPECT_NEAR(
      cast_ray(grid.geometry(), {4.5, 4.5}, -geometry::kPi / 2, 9, occupied_in(grid))->range, 3.5,
      1e-12);
  EXPECT_NEAR(cast_ray(grid.geometry(), {4.5, 4.5}, geometry::kPi / 2, 9, occupied_in(grid))->range,
              3.5, 1e-12);
}

TEST(CastRay, FindsNothingBeyondItsRange) {
  const OccupancyGrid grid = with_occupied({10, 1, 1.0, 0.0, 0.0}, {{7, 0}});
  EXPECT_FALSE(cast_ray(grid.geometry(), {0.5, 0.5}, 0.0, 6.49, occupied_in(grid)));
  EXPECT_TRUE(cast_ray(grid.geometry(), {0.5, 0.5}, 0.0, 6.51, occupied_in(grid)));
  EXPECT_TRUE(cast_ray(grid.geometry(), {0.5, 0.5}, 0.0, kInfinity, occupied_in(grid)));
  EXPECT_FALSE(cast_ray(grid.geometry(), {0.5, 0.5}, geometry::kPi, kInfinity, occupied_in(grid)));
}

TEST(CastRay, StartingInABlockingCellHasRangeZero) {
  const OccupancyGrid grid = with_occupied({3, 3, 1.0, 0.0, 0.0}, {{1, 1}});
  EXPECT_EQ(cast_ray(grid.geometry(), {1.3, 1.4}, 1.0, 5.0, occupied_in(grid))->range, 0.0);
}

TEST(CastRay, MayStartOutsideTheGrid) {
  const OccupancyGrid grid = with_occupied({4, 4, 1.0, 0.0, 0.0}, {{3, 2}, {0, 0}});
  EXPECT_NEAR(cast_ray(grid.geometry(), {-2.0, 2.5}, 0.0, 20.0, occupied_in(grid))->range, 5.0,
              1e-12);
  EXPECT_NEAR(cast_ray(grid.geometry(), {6.0, 2.5}, geometry::kPi, 20.0, occupied_in(grid))->range,
              2.0, 1e-12);
  EXPECT_FALSE(cast_ray(grid.geometry(), {-2.0, 9.0}, 0.0, 20.0, occupied_in(grid)));
}

TEST(CastRay, RefusesWhatIsNotANumber) {
  const OccupancyGrid grid = with_occupied({4, 4, 1.0, 0.0, 0.0}, {{3, 3}});
  EXPECT_FALSE(cast_ray(grid.geometry(), {kNan, 1.0}, 0.0, 5.0, occupied_in(grid)));
  EXPECT_FALSE(cast_ray(grid.geometry(), {1.0, kInfinity}, 0.0, 5.0, occupied_in(grid)));
  EXPECT_FALSE(cast_ray(grid.geometry(), {1.0, 1.0}, kNan, 5.0, occupied_in(grid)));
  EXPECT_FALSE(cast_ray(grid.geometry(), {1.0, 1.0}, 0.0, kNan, occupied_in(grid)));
  EXPECT_FALSE(cast_ray(grid.geometry(), {1.0, 1.0}, 0.0, -1.0, occupied_in(grid)));
}

TEST(CastRay, CannotSlipBetweenCellsThatTouchAtACorner) {
  const OccupancyGrid grid = with_occupied({8, 8, 1.0, 0.0, 0.0}, {{3, 4}, {4, 3}});
  EXPECT_TRUE(cast_ray(grid.geometry(), {0.5, 0.5}, geometry::kPi / 4, 20.0, occupied_in(grid)));
}

TEST(CastRay, AgreesWithMarchingInSmallSteps) {
  const OccupancyGrid grid = random_grid(5, 120, 90, 0.02);
  Random random(6);
  for (int i = 0; i < 2000; ++i) {
    const geometry::Point2 start{random.uniform(-3.0, 3.0), random.uniform(2.0, 6.5)};
    const double direction = random.uniform(-geometry::kPi, geometry::kPi);
    const auto hit = cast_ray(grid.geometry(), start, direction, 4.0, occupied_in(grid));
    double marched = kInfinity;
    for (double t = 0.0; t <= 4.0; t += 0.001) {
      const Cell cell = grid.geometry().cell_at(start.x() + t * std::cos(direction),
                                                start.y() + t * std::sin(direction));
      if (grid.value_or(cell, kFree) == kOccupied) {
        marched = t;
        break;
      }
    }
    // Marching may step over a cell's corner, never the other way round.
    if (hit) {
      EXPECT_LE(hit->range, marched + 1e-9);
      if (marched - hit->range > 0.0011) {
        const geometry::Point2 inside = grid.geometry().center(hit->cell) - start;
        const double offset =
            std::abs(inside.x() * std::sin(direction) - inside.y() * std::cos(direction));
        EXPECT_LE(offset, 0.05 * std::sqrt(0.5) + 1e-9) << "the ray crosses the cell that it names";
      }
    } else {
      EXPECT_EQ(marched, kInfinity);
    }
  }
}

TEST(CastRay, FlyingOverFreeSpaceChangesNothing) {
  for (const double share : {0.0005, 0.01, 0.2}) {
    const OccupancyGrid grid = random_grid(7, 300, 200, share);
    DistanceField field;
    field.build(grid, 1.0);
    Random random(8);
    for (int i = 0; i < 5000; ++i) {
      const geometry::Point2 start{random.uniform(-4.0, 13.0), random.uniform(1.0, 13.0)};
      const double direction = random.uniform(-geometry::kPi, geometry::kPi);
      const auto plain = cast_ray(grid.geometry(), start, direction, 8.0, occupied_in(grid));
      const auto flown = field.cast_ray(start, direction, 8.0);
      ASSERT_EQ(plain.has_value(), flown.has_value());
      if (!plain) continue;
      EXPECT_EQ(plain->cell, flown->cell);
      EXPECT_EQ(plain->range, flown->range);
    }
  }
}

TEST(Traverse, GoesFromEndToEndOverSharedEdges) {
  const GridGeometry geometry{50, 40, 0.1, -2.0, -1.0};
  Random random(9);
  for (int i = 0; i < 5000; ++i) {
    const geometry::Point2 from{random.uniform(-3.0, 4.0), random.uniform(-2.0, 4.0)};
    const geometry::Point2 to{random.uniform(-3.0, 4.0), random.uniform(-2.0, 4.0)};
    std::vector<Cell> cells;
    traverse(geometry, from, to, [&](Cell cell) { return cells.push_back(cell), true; });
    ASSERT_EQ(cells.front(), geometry.cell_at(from));
    ASSERT_EQ(cells.back(), geometry.cell_at(to));
    for (std::size_t k = 1; k < cells.size(); ++k) {
      ASSERT_EQ(std::abs(cells[k].x - cells[k - 1].x) + std::abs(cells[k].y - cells[k - 1].y), 1);
    }
  }
}

TEST(Traverse, OfAPointIsItsCell) {
  int count = 0;
  traverse({5, 5, 1.0, 0.0, 0.0}, {2.5, 2.5}, {2.5, 2.5}, [&](Cell) { return ++count, true; });
  EXPECT_EQ(count, 1);
}

TEST(Traverse, StopsWhenToldTo) {
  int count = 0;
  traverse({9, 9, 1.0, 0.0, 0.0}, {0.5, 0.5}, {8.5, 0.5}, [&](Cell) { return ++count < 3; });
  EXPECT_EQ(count, 3);
}

}  // namespace
}  // namespace usher::grid
