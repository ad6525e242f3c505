#include "navigation/local_planner/core/wavefront.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/local_planner/core/contact.hpp"
#include "navigation/local_planner/core/reference_path.hpp"

namespace usher::local_planner {
namespace {

using Costs = grid::Grid<std::uint8_t>;

std::vector<std::uint16_t> dijkstra(const Costs& costs, grid::Cell target) {
  const grid::GridGeometry& g = costs.geometry();
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
        const grid::Cell next{x + dx, y + dy};
        if (!g.contains(next) || costs.at(next) >= kCostInscribed) continue;
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
    const grid::Cell target{static_cast<int>(random.below(static_cast<std::uint64_t>(width))),
                            static_cast<int>(random.below(static_cast<std::uint64_t>(height)))};
    wavefront.set_obstacles(costs, kCostInscribed, false);
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
      costs.at({i, low}) = costs.at({i, high}) = costs.at({low, i}) = costs.at({high, i}) =
          kCostLethal;
    }
    costs.at({ring % 2 == 0 ? low : high, kSide / 2}) = 0;
  }
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kCostInscribed, false);
  wavefront.spread({kSide / 2, kSide / 2}, lengths);
  EXPECT_EQ(lengths, dijkstra(costs, {kSide / 2, kSide / 2}));
  EXPECT_LT(lengths[costs.geometry().index({0, kSide / 2})], Wavefront::kUnreachable);
}

TEST_P(WavefrontOn, FreeSpaceNeedsNoSecondRoundToSettle) {
  Costs costs({80, 80, 0.05, 0.0, 0.0});
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kCostInscribed, false);
  wavefront.spread({40, 40}, lengths);
  EXPECT_LE(wavefront.rounds(), 2);
  EXPECT_EQ(lengths[0], 40 * 7);
}

TEST_P(WavefrontOn, UnknownIsOpenUnlessClosed) {
  Costs costs({3, 1, 0.05, 0.0, 0.0});
  costs[1] = kCostUnknown;
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kCostInscribed, false);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths[2], 10);
  wavefront.set_obstacles(costs, kCostInscribed, true);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths[2], Wavefront::kUnreachable);
}

TEST_P(WavefrontOn, LongWaysSaturateInsteadOfWrapping) {
  constexpr int kSide = 301;  // a meander of about 45000 cells, 225000 units
  Costs costs({kSide, kSide, 0.05, 0.0, 0.0});
  for (int y = 1; y < kSide; y += 2) {
    for (int x = 0; x < kSide; ++x) costs.at({x, y}) = kCostLethal;
    costs.at({(y / 2) % 2 == 0 ? kSide - 1 : 0, y}) = 0;
  }
  Wavefront wavefront(GetParam());
  std::vector<std::uint16_t> lengths;
  wavefront.set_obstacles(costs, kCostInscribed, false);
  wavefront.spread({0, 0}, lengths);
  EXPECT_EQ(lengths.back(), Wavefront::kUnreachable);
  EXPECT_EQ(lengths[100], 500);
}

TEST(PolylineDistance, IsTheSameOnEveryInstructionSet) {
  Random random(2);
  PolylineDistance portable(cpu::Simd::kPortable);
  PolylineDistance best(cpu::best_simd());
  for (int i = 0; i < 60; ++i) {
    float c[4];
    for (float& v : c) v = static_cast<float>(random.uniform(-3, 3));
    portable.add(c[0], c[1], c[2], c[3]);
    best.add(c[0], c[1], c[2], c[3]);
  }
  std::vector<float> x(1000), y(1000), one(1000), other(1000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<float>(random.uniform(-4, 4)),
    y[i] = static_cast<float>(random.uniform(-4, 4));
  }
  portable.measure(x, y, one);
  best.measure(x, y, other);
  EXPECT_EQ(one, other);
}

TEST(PolylineDistance, KnowsSidesEndsAndPoints) {
  PolylineDistance line;
  line.add(0, 0, 2, 0);
  line.add(2, 0, 2, 0);
  const std::vector<float> x{1, -3, 5, 2, 0, 0, 0, 0};
  const std::vector<float> y{2, 4, 4, 0, 0, 0, 0, 3};
  std::vector<float> d(8);
  line.measure(x, y, d);
  EXPECT_EQ(d, (std::vector<float>{2, 5, 5, 0, 0, 0, 0, 3}));
  line.clear();
  line.measure(x, y, d);
  EXPECT_EQ(d[0], std::numeric_limits<float>::infinity());
}

std::vector<geometry::Pose2> there_and_back() {
  return {{0, 0, 0}, {5, 0, 0}, {5, 0.4, 0}, {0, 0.4, 1.0}};
}

TEST(ReferencePath, StaysOnItsLegWhereThePathPassesTwice) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  for (int i = 0; i <= 30; ++i) path.advance({0.1 * i, 0.25});  // nearer to the way back
  EXPECT_NEAR(path.progress(), 3.0, 0.05);
}

TEST(ReferencePath, FindsTheRobotAgainAfterAJump) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  path.advance({4.0, 0.0});
  EXPECT_NEAR(path.progress(), 4.0, 1e-9);
}

TEST(ReferencePath, RunsStraightOnBeyondItsEnd) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  EXPECT_NEAR(path.length(), 10.4, 1e-12);
  EXPECT_NEAR(path.at(10.9).x, -0.5, 1e-9);
  EXPECT_EQ(path.goal().yaw, 1.0);
}

TEST(ReferencePath, OnePoseIsAPath) {
  ReferencePath path;
  ASSERT_TRUE(path.set(std::vector<geometry::Pose2>{{1, 2, 0}, {1, 2, 0.5}}).ok());
  path.advance({0, 0});
  EXPECT_EQ(path.length(), 0.0);
  EXPECT_EQ(path.goal().yaw, 0.5);
  EXPECT_NEAR(path.at(0.0).x, 1.0, 1e-12);
}

TEST(ReferencePath, RefusesNothingAndNonsenseAndKeepsWhatItHas) {
  ReferencePath path;
  ASSERT_TRUE(path.set(there_and_back()).ok());
  EXPECT_FALSE(path.set({}).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Status status = path.set(std::vector<geometry::Pose2>{{0, 0, 0}, {nan, 0, 0}});
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().find("pose 1"), std::string::npos);
  EXPECT_NEAR(path.length(), 10.4, 1e-12);
}

}  // namespace
}  // namespace usher::local_planner
