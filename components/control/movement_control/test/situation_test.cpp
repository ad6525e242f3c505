#include "control/movement_control/core/situation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "foundation/geometry/angle.hpp"

namespace usher::movement_control {
namespace {

using std::chrono::milliseconds;

constexpr double kAngleMin = -2.0;
constexpr double kIncrement = 0.5 * geometry::kPi / 180.0;
constexpr int kBeams = 459;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A wall of the world as the half plane nx * x + ny * y >= d, with the normal pointing into it.
struct Wall {
  double nx, ny, d;
};

/// A scan from the origin, looking along `yaw`.
std::vector<float> scan(const std::vector<Wall>& walls, double yaw = 0.0) {
  std::vector<float> ranges;
  for (int i = 0; i < kBeams; ++i) {
    const double angle = yaw + kAngleMin + i * kIncrement;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      const double closing = wall.nx * std::cos(angle) + wall.ny * std::sin(angle);
      if (closing > 1e-9) nearest = std::min(nearest, wall.d / closing);
    }
    ranges.push_back(nearest > 20.0 ? kInfinity : static_cast<float>(nearest));
  }
  return ranges;
}

std::vector<Wall> corridor(double width) { return {{0, 1, width / 2}, {0, -1, width / 2}}; }
std::vector<Wall> area(double side) {
  return {{0, 1, side / 2}, {0, -1, side / 2}, {1, 0, side / 2}, {-1, 0, side / 2}};
}

FreeSpace measure(const std::vector<float>& ranges) {
  const auto space = free_space(ranges, kAngleMin, kIncrement, {});
  EXPECT_TRUE(space.has_value());
  return space.value_or(FreeSpace{});
}

TEST(FreeSpace, MeasuresACorridor) {
  for (const double width : {1.2, 1.4, 2.5}) {
    const FreeSpace space = measure(scan(corridor(width)));
    EXPECT_NEAR(space.width, width, 1e-6);
    EXPECT_EQ(space.ahead, 6.0);
  }
}

TEST(FreeSpace, MeasuresACorridorWhenStandingAskew) {
  const FreeSpace space = measure(scan(corridor(2.5), geometry::radians(10.0)));
  EXPECT_NEAR(space.width, 2.5, 0.12);
}

TEST(FreeSpace, MeasuresTheWayAhead) {
  std::vector<Wall> walls = corridor(2.5);
  walls.push_back({1, 0, 1.7});
  const FreeSpace space = measure(scan(walls));
  EXPECT_NEAR(space.ahead, 1.7, 0.01);
  EXPECT_NEAR(space.width, 2.5, 1e-6) << "the wall ahead is not a narrow place";
}

TEST(FreeSpace, OpenIsTheHorizon) {
  const FreeSpace space = measure(scan({}));
  EXPECT_EQ(space.ahead, 6.0);
  EXPECT_EQ(space.width, 12.0);
}

TEST(FreeSpace, KnowsNothingWhenBlindOnHalfOfWhatIsAhead) {
  std::vector<float> ranges = scan(corridor(3.0));
  for (int i = 0; i < kBeams; i += 3) ranges[static_cast<std::size_t>(i)] = kNan;
  EXPECT_NEAR(measure(ranges).width, 3.0, 0.05);
  for (int i = 1; i < kBeams; i += 3) ranges[static_cast<std::size_t>(i)] = kNan;
  EXPECT_FALSE(free_space(ranges, kAngleMin, kIncrement, {}).has_value());
}

TEST(FreeSpace, KnowsNothingWithoutForwardBeams) {
  EXPECT_FALSE(free_space({}, kAngleMin, kIncrement, {}).has_value());
  EXPECT_FALSE(free_space(std::vector<float>(kBeams, kNan), kAngleMin, kIncrement, {}).has_value());
  const std::vector<float> backward(10, 1.0F);
  EXPECT_FALSE(free_space(backward, geometry::kPi, 0.001, {}).has_value());
  EXPECT_FALSE(free_space(scan({}), std::nan(""), kIncrement, {}).has_value());
  EXPECT_FALSE(free_space(scan({}), kAngleMin, std::nan(""), {}).has_value());
}

TEST(FreeSpace, TooNearIsAnObstacle) {
  std::vector<float> ranges(kBeams, kInfinity);
  ranges[kBeams / 2] = -kInfinity;
  FreeSpaceParameters parameters;
  parameters.base_T_sensor = {0.2, 0.0, 0.0};
  const auto space = free_space(ranges, kAngleMin, kIncrement, parameters);
  ASSERT_TRUE(space.has_value());
  EXPECT_NEAR(space->ahead, 0.2, 1e-9);
}

TEST(FreeSpace, IgnoresUnknownBeamsAndKeepsTheRest) {
  std::vector<float> ranges = scan(corridor(1.4));
  for (std::size_t i = 0; i < ranges.size(); i += 3) ranges[i] = kNan;
  EXPECT_NEAR(measure(ranges).width, 1.4, 1e-6);
}

TEST(FreeSpace, TurnsWithTheMount) {
  FreeSpaceParameters parameters;
  parameters.base_T_sensor = {0.0, 0.0, geometry::kPi / 2};  // the sensor looks to the left
  std::vector<float> ranges(kBeams, kInfinity);
  ranges[static_cast<std::size_t>(std::lround((-geometry::kPi / 2 - kAngleMin) / kIncrement))] =
      1.5F;
  const auto space = free_space(ranges, kAngleMin, kIncrement, parameters);
  ASSERT_TRUE(space.has_value());
  EXPECT_NEAR(space->ahead, 1.5, 0.01);
}

TEST(Situation, FollowsTheClassesOfTheThesis) {
  struct Row {
    const char* name;
    std::vector<Wall> walls;
    Situation expected;
  };
  const Row rows[] = {
      {"nothing around", {}, Situation::kOpen},
      {"area of 4 x 4 m", area(4.0), Situation::kOpen},
      {"area of 3.4 x 3.4 m", area(3.4), Situation::kCorridor},
      {"area of 3 x 3 m", area(3.0), Situation::kCorridor},
      {"area of 2.5 x 2.5 m", area(2.5), Situation::kConfined},
      {"corridor of 2.5 m", corridor(2.5), Situation::kOpen},
      {"corridor of 2.3 m", corridor(2.3), Situation::kCorridor},
      {"corridor of 1.4 m", corridor(1.4), Situation::kCorridor},
      {"corridor of 1.2 m", corridor(1.2), Situation::kConfined},
      {"corridor of 2.5 m that ends after 3.5 m",
       {{0, 1, 1.25}, {0, -1, 1.25}, {1, 0, 3.5}},
       Situation::kCorridor},
      {"corridor of 1.4 m that ends after 2 m",
       {{0, 1, 0.7}, {0, -1, 0.7}, {1, 0, 2.0}},
       Situation::kConfined},
  };
  const SituationFilter filter;
  for (const Row& row : rows) {
    EXPECT_EQ(text(filter.classify(measure(scan(row.walls)))), text(row.expected)) << row.name;
  }
}

TEST(Situation, NarrowsAtOnceAndWidensAfterAWhile) {
  SituationFilter filter;
  const FreeSpace open{6.0, 12.0};
  const FreeSpace narrow{1.0, 1.0};
  const FreeSpace middle{6.0, 2.0};
  EXPECT_EQ(filter.update(open, milliseconds(0)), Situation::kConfined);
  EXPECT_EQ(filter.update(open, milliseconds(499)), Situation::kConfined);
  EXPECT_EQ(filter.update(open, milliseconds(500)), Situation::kOpen);
  EXPECT_EQ(filter.update(middle, milliseconds(520)), Situation::kCorridor);
  EXPECT_EQ(filter.update(narrow, milliseconds(540)), Situation::kConfined);
  EXPECT_EQ(filter.update(open, milliseconds(560)), Situation::kConfined);
  EXPECT_EQ(filter.update(narrow, milliseconds(900)), Situation::kConfined);
  EXPECT_EQ(filter.update(open, milliseconds(920)), Situation::kConfined);
  EXPECT_EQ(filter.update(middle, milliseconds(1000)), Situation::kConfined);
  EXPECT_EQ(filter.update(open, milliseconds(1420)), Situation::kCorridor)
      << "as wide as the narrowest of the wait";
  EXPECT_EQ(filter.update(std::nullopt, milliseconds(1440)), Situation::kConfined);
}

}  // namespace
}  // namespace usher::movement_control
