#include "foundation/grid/wavefront.hpp"

#include <gtest/gtest.h>

#include <queue>
#include <tuple>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::grid {
namespace {

using Costs = Grid<std::uint8_t>;
constexpr std::uint8_t kUnknownCost = 255, kLethal = 254, kClosed = 253;

std::vector<std::uint16_t> dijkstra(const Costs& costs, Cell target) {
  const GridGeometry& g = costs.geometry();
  std::vector<int> lengths(g.size(), Wavefront::kUnreachable);
  std::priority_queue<std::tuple<int, int, int>, std::vector<std::tuple<int, int, int>>,
                      std::greater<>>
      open;
  open.emplace(0, target.x, target.y);
  lengths[g.index(target)] = 0;
  while (!open.empty()) {
    const auto [length, x, y] = open.top();
    open.pop();
    if (length > lengths[g.index({x, y})]) continue;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const Cell next{x + dx, y + dy};
        if (!g.contains(next) || costs.at(next) >= kClosed) continue;
        const int sum = length + (dx != 0 && dy != 0 ? 7 : 5);
        if (sum >= lengths[g.index(next)]) continue;
        lengths[g.index(next)] = sum;
        open.emplace(sum, next.x, next.y);
      }
    }
  }
  return {lengths.begin(), lengths.end()};
}

class WavefrontOn : public testing::TestWithParam<cpu::Simd> {
 protected:
  void SetUp() override {
    if (GetParam() > cpu::best_simd()) GTEST_SKIP() << "this processor lacks the instruction set";
  }
};

INSTANTIATE_TEST_SUITE_P(InstructionSets, WavefrontOn,
                         testing::Values(cpu::Simd::kPortable, cpu::Simd::kAvx2));

TEST_P(WavefrontOn, EqualsDijkstraOnRandomGrids) {
  Random random(1);
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  for (int i = 0; i < 200; ++i) {
    const int width = 1 + static_cast<int>(random.below(100));
    const int height = 1 + static_cast<int>(random.below(100));
    Costs costs({width, height, 0.05, 0.0, 0.0});
    const double share = random.uniform(0.0, 0.6);
    for (std::uint8_t& cost : costs) cost = random.uniform() < share ? 253 : 0;
    const Cell target{static_cast<int>(random.below(static_cast<std::uint64_t>(width))),
                      static_cast<int>(random.below(static_cast<std::uint64_t>(height)))};
    wavefront.set_obstacles(costs, kClosed, false);
    wavefront.spread(target, lengths);
    ASSERT_EQ(lengths, dijkstra(costs, target)) << width << " x " << height;
  }
}

TEST_P(WavefrontOn, FindsTheWayOutOfASpiral) {
  constexpr int kSide = 61;
  Costs costs({kSide, kSide, 0.05, 0.0, 0.0});
  for (int ring = 0; ring < 15; ++ring) {  // closed rings with one gap each, on alternating sides
    const int low = 2 * ring;
    const int high = kSide - 1 - 2 * ring;
    for (int i = low; i <= high; ++i) {
      costs.at({i, low}) = costs.at({i, high}) = costs.at({low, i}) = costs.at({high, i}) = kLethal;
    }
    costs.at({ring % 2 == 0 ? low : high, kSide / 2}) = 0;
  }
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kClosed, false);
  wavefront.spread({kSide / 2, kSide / 2}, lengths);
  EXPECT_EQ(lengths, dijkstra(costs, {kSide / 2, kSide / 2}));
  EXPECT_LT(lengths[costs.geometry().index({0, kSide / 2})], Wavefront::kUnreachable);
}

TEST_P(WavefrontOn, FreeSpaceNeedsNoSecondRoundToSettle) {
  Costs costs({80, 80, 0.05, 0.0, 0.0});
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kClosed, false);
  wavefront.spread({40, 40}, lengths);
  EXPECT_LE(wavefront.rounds(), 2);
  EXPECT_EQ(lengths[0], 40 * 7);
}

TEST_P(WavefrontOn, UnknownIsOpenUnlessClosed) {
  Costs costs({3, 1, 0.05, 0.0, 0.0});
  costs[1] = kUnknownCost;
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kClosed, false);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths[2], 10);
  wavefront.set_obstacles(costs, kClosed, true);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths[2], Wavefront::kUnreachable);
}

TEST_P(WavefrontOn, LongWaysSaturateInsteadOfWrapping) {
  constexpr int kSide = 301;  // a meander of about 45000 cells, 225000 units
  Costs costs({kSide, kSide, 0.05, 0.0, 0.0});
  for (int y = 1; y < kSide; y += 2) {
    for (int x = 0; x < kSide; ++x) costs.at({x, y}) = kLethal;
    costs.at({(y / 2) % 2 == 0 ? kSide - 1 : 0, y}) = 0;
  }
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kClosed, false);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths.back(), Wavefront::kUnreachable);
  EXPECT_EQ(lengths[100], 500);
}

}  // namespace
}  // namespace usher::grid
