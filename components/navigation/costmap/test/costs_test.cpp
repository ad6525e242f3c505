#include "navigation/costmap/core/costs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace usher::costmap {
namespace {

constexpr CostDecay kDecay{.inscribed_radius = 0.3, .inflation_radius = 0.55, .cost_scaling = 10.0};

TEST(CostDecay, KnowsTheSymbolsOfCostmap2d) {
  EXPECT_EQ(kDecay.at(0.0), 254);
  EXPECT_EQ(kDecay.at(0.05), 253);
  EXPECT_EQ(kDecay.at(6 * 0.05), 253) << "0.30000000000000004 m is still the inscribed radius";
  EXPECT_EQ(kDecay.at(0.35), 152) << "252 exp(-10 * 0.05) = 152.8";
  EXPECT_EQ(kDecay.at(0.55), 20) << "252 exp(-10 * 0.25) = 20.7";
  EXPECT_EQ(kDecay.at(0.56), 0);
  EXPECT_EQ(kDecay.at(std::numeric_limits<double>::infinity()), 0);
}

TEST(CostDecay, NeverRisesWithDistance) {
  for (double distance = 0.0; distance < 0.7; distance += 0.001) {
    EXPECT_GE(kDecay.at(distance), kDecay.at(distance + 0.001)) << distance;
  }
}

TEST(OccupancyOfCost, IsThatOfRos) {
  EXPECT_EQ(kOccupancyOfCost[kFreeCost], 0);
  EXPECT_EQ(kOccupancyOfCost[1], 1);
  EXPECT_EQ(kOccupancyOfCost[252], 98);
  EXPECT_EQ(kOccupancyOfCost[kInscribedCost], 99);
  EXPECT_EQ(kOccupancyOfCost[kLethalCost], 100);
  EXPECT_EQ(kOccupancyOfCost[kUnknownCost], -1);
  for (std::size_t cost = 1; cost < 254; ++cost)
    EXPECT_LE(kOccupancyOfCost[cost], kOccupancyOfCost[cost + 1]);
}

}  // namespace
}  // namespace usher::costmap
