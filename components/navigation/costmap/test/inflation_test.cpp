#include "navigation/costmap/core/inflation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "foundation/random/random.hpp"
#include "navigation/costmap/test/reference_costmap.hpp"
#include "navigation/costmap/test/willow.hpp"
#include "support/data.hpp"

namespace usher::costmap {
namespace {

using cpu::Simd;
using Unseen = Inflation::Unseen;

grid::Grid<std::uint8_t> random_states(Random& random, int width, int height, double occupied,
                                       double unseen) {
  grid::Grid<std::uint8_t> states({width, height, 0.05, 0.0, 0.0}, kSeenFree);
  for (std::uint8_t& state : states) {
    const double draw = random.uniform();
    state = draw < occupied ? kSeenOccupied : draw < occupied + unseen ? kUnseen : kSeenFree;
  }
  return states;
}

void write_states(const grid::Grid<std::uint8_t>& states, Inflation& inflation) {
  for (int y = 0; y < states.height(); ++y)
    std::copy_n(states.row(y), states.width(), inflation.state_row(y));
}

grid::Grid<std::uint8_t> inflated(const grid::Grid<std::uint8_t>& states, const CostDecay& decay,
                                  Unseen unseen, Simd simd) {
  Inflation inflation(states.width(), states.height(), states.resolution(), decay, unseen, simd);
  write_states(states, inflation);
  grid::Grid<std::uint8_t> master(states.geometry(), 111);
  inflation.update({0, 0, states.width(), states.height()}, master);
  return master;
}

grid::Grid<std::uint8_t> reference(const grid::Grid<std::uint8_t>& states, const CostDecay& decay,
                                   Unseen unseen) {
  grid::Grid<std::uint8_t> master(states.geometry());
  for (std::size_t i = 0; i < states.size(); ++i) {
    master[i] = ReferenceCostmap::cost(states, states.geometry().cell(i), decay, unseen);
  }
  return master;
}

class InflationLaw : public testing::TestWithParam<double> {};  // the inflation radius

TEST_P(InflationLaw, CostsAreThoseOfTheNearestObstacleByBruteForce) {
  Random random(static_cast<std::uint64_t>(GetParam() * 1000));
  for (int round = 0; round < 24; ++round) {
    const int width = 1 + static_cast<int>(random.below(130));
    const int height = 1 + static_cast<int>(random.below(60));
    const double densities[] = {0.0005, 0.01, 0.2};
    const auto states = random_states(random, width, height, densities[round % 3], 0.3);
    const CostDecay decay{std::min(GetParam(), 0.17), GetParam(), 2.0 / std::max(0.1, GetParam())};
    const auto unseen = static_cast<Unseen>(round % 3);
    const auto expected = reference(states, decay, unseen);
    for (const Simd simd : {Simd::kPortable, cpu::best_simd()}) {
      ASSERT_EQ(inflated(states, decay, unseen, simd).values(), expected.values())
          << width << " x " << height << " simd " << static_cast<int>(simd);
    }
  }
}

// 0, 1, 11, 14, 15, 30, 31 and 60 cells: every kernel and its borders.
INSTANTIATE_TEST_SUITE_P(Radii, InflationLaw,
                         testing::Values(0.0, 0.05, 0.55, 0.7, 0.75, 1.5, 1.55, 3.0));

TEST(Inflation, ReachesTheWidestRadius) {
  grid::Grid<std::uint8_t> states({300, 5, 0.05, 0.0, 0.0}, kSeenFree);
  states.at({150, 2}) = kSeenOccupied;
  const CostDecay decay{0.3, 6.0, 0.1};
  for (const Simd simd : {Simd::kPortable, cpu::best_simd()}) {
    EXPECT_EQ(inflated(states, decay, Unseen::kFree, simd).values(),
              reference(states, decay, Unseen::kFree).values());
  }
}

TEST(Inflation, OfAChangedRectangleEqualsAFreshOne) {
  Random random(3);
  for (const double radius : {0.2, 0.55, 1.2}) {
    const CostDecay decay{0.1, radius, 3.0};
    auto states = random_states(random, 173, 91, 0.01, 0.2);
    Inflation inflation(173, 91, 0.05, decay, Unseen::kUnknown);
    grid::Grid<std::uint8_t> master(states.geometry());
    write_states(states, inflation);
    inflation.update({0, 0, 173, 91}, master);
    for (int round = 0; round < 200; ++round) {
      const int x0 = static_cast<int>(random.below(173));
      const int y0 = static_cast<int>(random.below(91));
      const CellRect rect{x0, y0, x0 + 1 + static_cast<int>(random.below(40)),
                          y0 + 1 + static_cast<int>(random.below(20))};
      const CellRect inside = rect.within({0, 0, 173, 91});
      for (int y = inside.y0; y < inside.y1; ++y) {
        for (int x = inside.x0; x < inside.x1; ++x) {
          states.at({x, y}) = random.uniform() < 0.02 ? kSeenOccupied : kSeenFree;
        }
      }
      write_states(states, inflation);
      const auto before = master;
      const CellRect written = inflation.update(rect, master);
      ASSERT_EQ(master.values(),
                inflated(states, decay, Unseen::kUnknown, cpu::best_simd()).values())
          << round;
      for (std::size_t i = 0; i < master.size(); ++i) {
        const grid::Cell c = master.geometry().cell(i);
        const bool inside_written =
            c.x >= written.x0 && c.x < written.x1 && c.y >= written.y0 && c.y < written.y1;
        ASSERT_TRUE(inside_written || master[i] == before[i]);
      }
    }
  }
}

TEST(Inflation, OfNothingWritesNothing) {
  Inflation inflation(10, 10, 0.05, {0.1, 0.3, 3.0}, Unseen::kFree);
  grid::Grid<std::uint8_t> master({10, 10, 0.05, 0.0, 0.0}, 7);
  EXPECT_TRUE(inflation.update({}, master).empty());
  EXPECT_TRUE(inflation.update({20, 20, 30, 30}, master).empty());
  EXPECT_EQ(master.values(), std::vector<std::uint8_t>(100, 7));
}

// costmap_2d grows costs cell by cell from each obstacle, which misses the nearest obstacle of a
// few cells; then its cost is lower than the true one by a little, never higher.
TEST(Inflation, OfTheWillowMapIsThatOfCostmap2dOrNearer) {
  USHER_REQUIRE_DATA(map_path, "peers/willow-1000x1000-0.05.pgm");
  USHER_REQUIRE_DATA(costmap_path, "peers/willow-1000-costmap-0.55.raw");
  const std::vector<std::uint8_t> theirs = bytes_of(costmap_path);
  const grid::OccupancyGrid map = willow_map(map_path, 0.0, 0.0);
  ASSERT_EQ(theirs.size(), 1000000U);
  ASSERT_EQ(map.size(), 1000000U);
  grid::Grid<std::uint8_t> states(map.geometry());
  std::transform(map.begin(), map.end(), states.begin(), [](std::int8_t occupancy) {
    return occupancy < 0 ? kUnseen : occupancy == grid::kOccupied ? kSeenOccupied : kSeenFree;
  });
  const CostDecay decay{0.3 * std::cos(geometry::kPi / 16.0), 0.55, 10.0};
  const auto ours = inflated(states, decay, Unseen::kUnknown, cpu::best_simd());
  int differing = 0;
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    if (ours[i] == theirs[i]) continue;
    ++differing;
    if (theirs[i] == kUnknownCost) {
      ASSERT_EQ(ours[i], kInscribedCost) << "cell " << i;
    } else {
      ASSERT_GT(ours[i], theirs[i]) << "cell " << i;
    }
  }
  RecordProperty("differing", differing);
  EXPECT_LT(differing, 1000) << "of a million cells";
}

}  // namespace
}  // namespace usher::costmap
