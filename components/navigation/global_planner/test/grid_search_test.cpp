#include <gtest/gtest.h>

#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/global_planner/core/grid_search.hpp"

namespace usher::global_planner {
namespace {

/// The cheapest cost to every cell by a textbook Dijkstra; kBlocked where there is no path.
std::vector<std::uint32_t> reference_costs(const CostGrid& costs, const StepCosts& steps,
                                           grid::Cell start) {
  const grid::GridGeometry& g = costs.geometry();
  std::vector<std::uint32_t> best(costs.size(), StepCosts::kBlocked);
  using Entry = std::pair<std::uint32_t, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto free = [&](int x, int y) {
    return steps.straight[costs.value_or({x, y}, grid::kLethalCost)] != StepCosts::kBlocked;
  };
  best[g.index(start)] = 0;
  open.emplace(0, g.index(start));
  while (!open.empty()) {
    const auto [cost, index] = open.top();
    open.pop();
    if (cost > best[index]) continue;
    const grid::Cell c = g.cell(index);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!free(c.x + dx, c.y + dy) || !free(c.x + dx, c.y) || !free(c.x, c.y + dy)) continue;
        const std::size_t to = g.index({c.x + dx, c.y + dy});
        const std::uint32_t total =
            cost + (dx != 0 && dy != 0 ? steps.diagonal : steps.straight)[costs[to]];
        if (total < best[to]) best[to] = total, open.emplace(total, to);
      }
    }
  }
  return best;
}

/// Noise of obstacles, steps of cost and, on some maps, corridors.
CostGrid random_map(Random& random) {
  CostGrid costs({.width = 2 + static_cast<int>(random.below(60)),
                  .height = 2 + static_cast<int>(random.below(60)),
                  .resolution = 0.05});
  const double blocked = random.uniform(0.0, 0.45);
  const double costly = random.uniform();
  for (auto& cost : costs) {
    if (random.uniform() < blocked) {
      cost = static_cast<std::uint8_t>(grid::kInscribedCost + random.below(3));
    } else {
      cost = random.uniform() < costly
                 ? static_cast<std::uint8_t>(random.below(grid::kInscribedCost))
                 : 0;
    }
  }
  return costs;
}

std::uint32_t cost_of(const CostField& field, const std::vector<grid::Cell>& cells) {
  std::uint32_t sum = 0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const grid::Cell a = cells[i - 1];
    const grid::Cell b = cells[i];
    EXPECT_LE(std::max(std::abs(a.x - b.x), std::abs(a.y - b.y)), 1);
    EXPECT_TRUE(field.traversable(b) && field.traversable({a.x, b.y}) &&
                field.traversable({b.x, a.y}));
    const bool diagonal = a.x != b.x && a.y != b.y;
    sum += (diagonal ? field.steps().diagonal : field.steps().straight)[field.cost(b)];
  }
  return sum;
}

class GridSearchCosts : public testing::TestWithParam<StepCosts> {};

TEST_P(GridSearchCosts, EqualTheReferenceOnRandomMaps) {
  Random random(7);
  CostField field(GetParam());
  GridSearch search;  // one for all maps: what an earlier search left must not matter
  std::vector<grid::Cell> cells;
  int reached = 0;
  for (int map = 0; map < 400; ++map) {
    const CostGrid costs = random_map(random);
    field.load(costs);
    for (int query = 0; query < 6; ++query) {
      const grid::Cell start = costs.geometry().cell(random.below(costs.size()));
      const grid::Cell goal = costs.geometry().cell(random.below(costs.size()));
      if (!field.traversable(start) || !field.traversable(goal)) continue;
      const auto expected = reference_costs(costs, field.steps(), start);
      const std::uint32_t best = expected[costs.geometry().index(goal)];
      for (const bool informed : {false, true}) {
        const SearchOutcome outcome = search.run(field, start, goal, informed);
        if (best == StepCosts::kBlocked) {
          ASSERT_EQ(outcome, SearchOutcome::kDisconnected);
          for (std::size_t i = 0; i < costs.size(); ++i)
            ASSERT_EQ(search.reached(field, costs.geometry().cell(i)),
                      expected[i] != StepCosts::kBlocked);
          continue;
        }
        ASSERT_EQ(outcome, SearchOutcome::kReached);
        ASSERT_EQ(search.cost_to(field, goal), best) << "map " << map << " informed " << informed;
        search.trace(field, goal, cells);
        ASSERT_EQ(cells.front(), start);
        ASSERT_EQ(cells.back(), goal);
        ASSERT_EQ(cost_of(field, cells), best);
        ++reached;
      }
    }
  }
  EXPECT_GT(reached, 500);
}

INSTANTIATE_TEST_SUITE_P(Metrics, GridSearchCosts,
                         testing::Values(StepCosts::shortest(false), StepCosts::shortest(true),
                                         StepCosts::inflated(50, 0.8, false, 0),
                                         StepCosts::inflated(50, 3, true, 80),
                                         StepCosts::inflated(1, 0, false, 0),
                                         StepCosts::inflated(10, 2.3, false, 0),
                                         StepCosts::inflated(1000, 238, true, 252)));

TEST(GridSearch, CountsPathsLongerThanTheFirstSpan) {
  // A serpentine of costly cells: its cost exceeds 2^26 and is still exact.
  CostGrid costs({.width = 401, .height = 401, .resolution = 0.05}, 252);
  for (int y = 1; y < 400; y += 2)
    for (int x = 0; x < 401; ++x)
      if (x != (y % 4 == 1 ? 400 : 0)) costs.at({x, y}) = grid::kLethalCost;
  CostField field(StepCosts::inflated(50, 0.8, false, 0));
  field.load(costs);
  GridSearch search;
  const auto expected = reference_costs(costs, field.steps(), {0, 0});
  for (int repeat = 0; repeat < 3; ++repeat) {
    ASSERT_EQ(search.run(field, {0, 0}, {400, 400}, repeat % 2 == 1), SearchOutcome::kReached);
    EXPECT_GT(search.cost_to(field, {400, 400}), 1u << 26);
    EXPECT_EQ(search.cost_to(field, {400, 400}), expected[costs.geometry().index({400, 400})]);
    ASSERT_EQ(search.run(field, {0, 0}, {5, 0}, false), SearchOutcome::kReached);
    EXPECT_EQ(search.cost_to(field, {5, 0}), expected[5]);
  }
}

TEST(GridSearch, ReportsAPathThatCostsMoreThanItCanCount) {
  CostGrid costs({.width = 401, .height = 401, .resolution = 0.05}, 252);
  for (int y = 1; y < 400; y += 2)
    for (int x = 0; x < 401; ++x)
      if (x != (y % 4 == 1 ? 400 : 0)) costs.at({x, y}) = grid::kLethalCost;
  CostField field(StepCosts::inflated(1000, 238, false, 0));
  field.load(costs);
  GridSearch search;
  EXPECT_EQ(search.run(field, {0, 0}, {400, 400}, false), SearchOutcome::kTooLong);
  EXPECT_EQ(search.run(field, {0, 0}, {5, 0}, false), SearchOutcome::kReached);
}

TEST(GridSearch, RepeatsItselfOverManyGenerations) {
  Random random(3);
  const CostGrid costs = random_map(random);
  CostField field(StepCosts::inflated(50, 0.8, false, 0));
  field.load(costs);
  GridSearch often;
  std::vector<grid::Cell> a, b;
  grid::Cell start{};
  grid::Cell goal{};
  for (int i = 0; i < 100; ++i) {
    do start = costs.geometry().cell(random.below(costs.size()));
    while (!field.traversable(start));
    do goal = costs.geometry().cell(random.below(costs.size()));
    while (!field.traversable(goal));
    GridSearch fresh;
    const SearchOutcome outcome = fresh.run(field, start, goal, true);
    ASSERT_EQ(often.run(field, start, goal, true), outcome);
    ASSERT_EQ(often.expanded(), fresh.expanded());
    if (outcome != SearchOutcome::kReached) continue;
    fresh.trace(field, goal, a);
    often.trace(field, goal, b);
    ASSERT_EQ(a, b);
  }
}

}  // namespace
}  // namespace usher::global_planner
