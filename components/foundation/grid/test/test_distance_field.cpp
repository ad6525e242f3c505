#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "foundation/grid/distance_field.hpp"
#include "foundation/random/random.hpp"

namespace usher::grid {
namespace {

OccupancyGrid random_grid(std::uint64_t seed, int width, int height, double share) {
  Random random(seed);
  OccupancyGrid grid({width, height, 0.05, 1.0, -2.0}, kFree);
  for (auto& cell : grid) {
    const double u = random.uniform();
    cell = u < share ? kOccupied : u < 0.5 ? kUnknown : kFree;
  }
  return grid;
}

int brute_force(const OccupancyGrid& grid, Cell from, int radius) {
  int best = radius * radius;
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      if (grid.at({x, y}) != kOccupied) continue;
      best = std::min(best, (x - from.x) * (x - from.x) + (y - from.y) * (y - from.y));
    }
  }
  return best;
}

TEST(DistanceField, IsExactOnRandomGrids) {
  struct Case {
    int width, height;
    double share, radius;
  };
  for (const Case& c : {Case{70, 45, 0.01, 0.5},
                        {33, 64, 0.2, 2.0},
                        {1, 50, 0.05, 1.0},
                        {50, 1, 0.05, 1.0},
                        {31, 31, 0.002, 9.0},
                        {97, 20, 0.001, 0.05}}) {
    const OccupancyGrid grid = random_grid(3, c.width, c.height, c.share);
    DistanceField field;
    field.build(grid, c.radius);
    for (int y = 0; y < c.height; ++y) {
      for (int x = 0; x < c.width; ++x) {
        ASSERT_EQ(field.squared_cells().at({x, y}), brute_force(grid, {x, y}, field.radius_cells()))
            << x << "," << y;
      }
    }
  }
}

TEST(DistanceField, IsTheSameOnEveryInstructionSet) {
  const OccupancyGrid grid = random_grid(4, 517, 211, 0.003);
  DistanceField portable;
  portable.build(grid, 2.0, kOccupied, cpu::Simd::kPortable);
  for (int set = 1; set <= static_cast<int>(cpu::best_simd()); ++set) {
    DistanceField field;
    field.build(grid, 2.0, kOccupied, static_cast<cpu::Simd>(set));
    EXPECT_EQ(field.squared_cells(), portable.squared_cells());
  }
}

TEST(DistanceField, OfAMapWithoutWallsIsTheRadius) {
  DistanceField field;
  field.build(OccupancyGrid({40, 30, 0.05, 0.0, 0.0}, kUnknown), 0.75);
  EXPECT_DOUBLE_EQ(field.radius(), 0.75);
  EXPECT_NEAR(field.distance({7, 7}), 0.75, 1e-7);
}

TEST(DistanceField, OfAnEmptyMapIsEmpty) {
  DistanceField field;
  field.build(OccupancyGrid(), 1.0);
  EXPECT_TRUE(field.empty());
  EXPECT_FALSE(field.cast_ray({0.0, 0.0}, 0.0, 5.0));
}

TEST(DistanceField, LimitsItsRadius) {
  DistanceField field;
  field.build(random_grid(1, 20, 20, 0.1), 1e6);
  EXPECT_EQ(field.radius_cells(), DistanceField::kMaxRadius);
  field.build(random_grid(1, 20, 20, 0.1), 1e-6);
  EXPECT_EQ(field.radius_cells(), 1);
}

TEST(DistanceField, ForgetsTheLastMap) {
  DistanceField field;
  field.build(random_grid(1, 64, 64, 0.3), 1.0);
  field.build(OccupancyGrid({64, 64, 0.05, 0.0, 0.0}, kFree), 1.0);
  EXPECT_NEAR(field.distance({30, 30}), 1.0, 1e-7);
}

TEST(DistanceField, HonoursTheThresholdOfOccupied) {
  OccupancyGrid grid({9, 9, 1.0, 0.0, 0.0}, kFree);
  grid.at({4, 4}) = 60;
  DistanceField field;
  field.build(grid, 3.0, 65);
  EXPECT_EQ(field.distance({4, 4}), 3.0);
  field.build(grid, 3.0, 60);
  EXPECT_EQ(field.distance({4, 4}), 0.0);
}

TEST(DistanceField, InterpolatesWithItsOwnGradient) {
  const OccupancyGrid grid = random_grid(11, 60, 60, 0.01);
  DistanceField field;
  field.build(grid, 1.0);
  Random random(12);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 500; ++i) {
    const geometry::Point2 p{random.uniform(1.1, 3.8), random.uniform(-1.8, 0.8)};
    const auto sample = field.interpolated(p);
    const double right = field.interpolated({p.x() + kStep, p.y()}).distance;
    const double above = field.interpolated({p.x(), p.y() + kStep}).distance;
    EXPECT_NEAR((right - sample.distance) / kStep, sample.gradient.x(), 1e-3);
    EXPECT_NEAR((above - sample.distance) / kStep, sample.gradient.y(), 1e-3);
  }
  EXPECT_NEAR(field.interpolated(grid.geometry().center({20, 30})).distance,
              field.distance({20, 30}), 1e-7);
}

TEST(DistanceField, IsTheRadiusOutsideTheMap) {
  DistanceField field;
  field.build(random_grid(11, 60, 60, 0.1), 1.0);
  for (const geometry::Point2& p :
       {geometry::Point2{0.0, 0.0}, {100.0, 0.0}, {std::nan(""), 0.0}}) {
    EXPECT_EQ(field.interpolated(p).distance, field.radius());
    EXPECT_EQ(field.interpolated(p).gradient.norm(), 0.0);
  }
}

}  // namespace
}  // namespace usher::grid
