#include "control/movement_control/core/lethal_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "foundation/random/random.hpp"

namespace usher::movement_control {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Window {
  explicit Window(std::size_t cells = 120) : costs(cells * cells), side(cells) {}
  CostsView view() const {
    const double half = 0.025 * static_cast<double>(side);
    return {costs, side, side, 0.05, {4.0 - half, -2.0 - half}};
  }
  std::vector<std::uint8_t> costs;
  std::size_t side;
};

std::vector<std::pair<double, double>> sorted(std::span<const Point2> points) {
  std::vector<std::pair<double, double>> all;
  for (const Point2& p : points) all.emplace_back(std::round(1e6 * p.x()), std::round(1e6 * p.y()));
  std::sort(all.begin(), all.end());
  return all;
}

TEST(LethalCells, AreThoseWhoseCentersAreWithinReach) {
  Random random(5);
  LethalCells lethal;
  for (int run = 0; run < 300; ++run) {
    Window window(20 + random.below(120));
    for (std::uint8_t& cost : window.costs) {
      if (random.below(12) == 0) cost = static_cast<std::uint8_t>(252 + random.below(4));
    }
    const CostsView view = window.view();
    const Pose2 pose{4.0 + random.uniform(-0.4, 0.4), -2.0 + random.uniform(-0.4, 0.4),
                     random.uniform(-3.0, 3.0)};
    const double reach = random.uniform(0.0, 5.0);
    std::vector<Point2> expected;
    for (std::size_t i = 0; i < window.costs.size(); ++i) {
      if (window.costs[i] != 254) continue;
      const Point2 cell(static_cast<double>(i % view.width), static_cast<double>(i / view.width));
      const Point2 center = view.origin.array() + 0.05 * (cell.array() + 0.5);
      const Point2 seen = geometry::inverse(pose) * center;
      if (seen.norm() <= reach) expected.push_back(seen);
    }
    ASSERT_EQ(sorted(lethal.around(pose, view, reach)), sorted(expected)) << run;
  }
}

TEST(LethalCells, AreNoneInWhatIsNoWindow) {
  Window window;
  std::fill(window.costs.begin(), window.costs.end(), std::uint8_t{254});
  const Pose2 here{4.0, -2.0, 0.0};
  LethalCells lethal;
  ASSERT_FALSE(lethal.around(here, window.view(), 1.0).empty());
  EXPECT_TRUE(lethal.around({40.0, -2.0, 0.0}, window.view(), 1e9).empty()) << "not in it";
  EXPECT_TRUE(lethal.around({kNan, -2.0, 0.0}, window.view(), 1.0).empty());
  EXPECT_TRUE(lethal.around(here, window.view(), kNan).empty());
  EXPECT_TRUE(lethal.around(here, {}, 1.0).empty());
  CostsView torn = window.view();
  ++torn.height;
  EXPECT_TRUE(lethal.around(here, torn, 1.0).empty());
  CostsView flat = window.view();
  flat.resolution = 0.0;
  EXPECT_TRUE(lethal.around(here, flat, 1.0).empty());
  CostsView nowhere = window.view();
  nowhere.origin.x() = kNan;
  EXPECT_TRUE(lethal.around(here, nowhere, 1.0).empty());
}

TEST(LethalCells, AreBoundedAndTheNearestRowsComeFirst) {
  Window window(400);
  std::fill(window.costs.begin(), window.costs.end(), std::uint8_t{254});
  LethalCells lethal;
  const auto cells = lethal.around({4.0, -2.0, 0.0}, window.view(), 1e9);
  ASSERT_EQ(cells.size(), 4096U);
  for (const Point2& cell : cells) ASSERT_LE(std::abs(cell.y()), 0.05 * 6);
}

}  // namespace
}  // namespace usher::movement_control
