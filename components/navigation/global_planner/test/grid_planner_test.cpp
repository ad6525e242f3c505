#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/global_planner/core/grid_planner.hpp"
#include "support/counted_new.hpp"

namespace usher::global_planner {
namespace {

using geometry::Pose2;

constexpr double kResolution = 0.05;

CostGrid room(int width, int height) {
  return CostGrid({.width = width,
                   .height = height,
                   .resolution = kResolution,
                   .origin_x = -1.0,
                   .origin_y = 2.0});
}

Pose2 at(const CostGrid& costs, int x, int y, double yaw = 0.0) {
  const auto p = costs.geometry().center({x, y});
  return {p.x(), p.y(), yaw};
}

void fill(CostGrid& costs, int x0, int y0, int x1, int y1, std::uint8_t value) {
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) costs.at({x, y}) = value;
}

GridPlanner planner(const GridPlannerConfig& config = {}) { return *GridPlanner::create(config); }

/// Whether a segment passes through the inside of a cell [m]: clipped against its four sides
/// (Liang-Barsky), shared with nothing in the planner.
bool crosses(const Pose2& a, const Pose2& b, double x0, double y0, double side) {
  double enter = 0.0;
  double leave = 1.0;
  const double margin = 1e-7;
  const double p[4] = {a.x - b.x, b.x - a.x, a.y - b.y, b.y - a.y};
  const double q[4] = {a.x - x0 - margin, x0 + side - margin - a.x, a.y - y0 - margin,
                       y0 + side - margin - a.y};
  for (int i = 0; i < 4; ++i) {
    if (std::abs(p[i]) < 1e-15) {
      if (q[i] < 0.0) return false;
    } else if (p[i] < 0.0) {
      enter = std::max(enter, q[i] / p[i]);
    } else {
      leave = std::min(leave, q[i] / p[i]);
    }
  }
  return enter < leave;
}

/// The promise of a path over cells below grid::kInscribedCost: starts and ends where it should,
/// small steps, nothing blocked inside or diagonally beside it.
void expect_safe(const Plan& plan, const CostGrid& costs, std::size_t from = 0) {
  const grid::GridGeometry& g = costs.geometry();
  double length = 0.0;
  for (std::size_t i = 1; i < plan.path.size(); ++i) {
    const Pose2& a = plan.path[i - 1];
    const Pose2& b = plan.path[i];
    const double step = geometry::distance(a, b);
    length += step;
    ASSERT_LT(step, std::sqrt(2.0) * kResolution + 1e-9);
    ASSERT_NEAR(geometry::shortest_turn(a.yaw, std::atan2(b.y - a.y, b.x - a.x)), 0.0, 1e-9);
    if (i <= from) continue;
    const grid::Cell ca = g.cell_at(a.x, a.y);
    const grid::Cell cb = g.cell_at(b.x, b.y);
    for (int y = std::min(ca.y, cb.y) - 1; y <= std::max(ca.y, cb.y) + 1; ++y) {
      for (int x = std::min(ca.x, cb.x) - 1; x <= std::max(ca.x, cb.x) + 1; ++x) {
        if (costs.value_or({x, y}, grid::kLethalCost) < grid::kInscribedCost) continue;
        ASSERT_FALSE(crosses(a, b, g.origin_x + x * g.resolution, g.origin_y + y * g.resolution,
                             g.resolution))
            << "segment " << i << " from (" << a.x << ", " << a.y << ") to (" << b.x << ", " << b.y
            << ") cell " << x << ", " << y;
      }
    }
    // A diagonal change of cells needs one more free cell than the two: a line through a closed
    // corner has none.
    if (ca.x != cb.x && ca.y != cb.y) {
      ASSERT_TRUE(costs.at({ca.x, cb.y}) < grid::kInscribedCost ||
                  costs.at({cb.x, ca.y}) < grid::kInscribedCost);
    }
  }
  ASSERT_NEAR(plan.length, length, 1e-9);
}

TEST(GridPlanner, RefusesParametersOutOfRangeByName) {
  EXPECT_EQ(GridPlanner::create({.neutral_cost = 0.0}).error(),
            "neutral_cost must be in [1, 1000], got 0");
  EXPECT_NE(GridPlanner::create({.cost_factor = 100.0}).error().find("cost_factor"),
            std::string::npos);
  EXPECT_NE(GridPlanner::create({.unknown_cost = 253}).error().find("unknown_cost"),
            std::string::npos);
  EXPECT_NE(GridPlanner::create({.escape_radius = -1.0}).error().find("escape_radius"),
            std::string::npos);
  EXPECT_NE(GridPlanner::create({.goal_tolerance = std::nan("")}).error().find("goal_tolerance"),
            std::string::npos);
  EXPECT_NE(GridPlanner::create({.smoothing_iterations = -1}).error().find("smoothing_iterations"),
            std::string::npos);
}

TEST(GridPlanner, GoesStraightThroughAnEmptyRoom) {
  const CostGrid costs = room(100, 80);
  for (const auto algorithm : {Algorithm::kDijkstra, Algorithm::kAstar}) {
    GridPlanner p = planner({.algorithm = algorithm});
    const Pose2 start{-0.913, 2.207, 1.0};
    const Pose2 goal{3.421, 5.113, -2.0};
    const Plan& plan = p.plan(costs, start, goal);
    ASSERT_TRUE(plan.ok()) << plan.reason;
    EXPECT_NEAR(plan.length, geometry::distance(start, goal), 1e-3);
    EXPECT_EQ(plan.path.front().position(), start.position());
    EXPECT_NEAR(geometry::distance(plan.path.back(), goal), 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(plan.path.back().yaw, goal.yaw);
    EXPECT_EQ(plan.goal_shift, 0.0);
    EXPECT_EQ(plan.escape_distance, 0.0);
    expect_safe(plan, costs);
  }
}

TEST(GridPlanner, PathsAreSafeOnRandomMaps) {
  Random random(11);
  int planned = 0;
  for (int map = 0; map < 300; ++map) {
    CostGrid costs =
        room(20 + static_cast<int>(random.below(60)), 20 + static_cast<int>(random.below(60)));
    const double blocked = random.uniform(0.02, 0.35);
    for (auto& cost : costs)
      cost = static_cast<std::uint8_t>(random.uniform() < blocked
                                           ? grid::kInscribedCost + random.below(3)
                                           : random.below(grid::kInscribedCost));
    GridPlanner p = planner({.algorithm = map % 2 == 0 ? Algorithm::kDijkstra : Algorithm::kAstar,
                             .metric = map % 3 == 0 ? Metric::kShortest : Metric::kInflated,
                             .smoothing_iterations = static_cast<int>(random.below(40))});
    for (int query = 0; query < 5; ++query) {
      const auto& g = costs.geometry();
      const Pose2 start{g.origin_x + random.uniform() * g.width * kResolution,
                        g.origin_y + random.uniform() * g.height * kResolution, 0.0};
      const Pose2 goal{g.origin_x + random.uniform() * g.width * kResolution,
                       g.origin_y + random.uniform() * g.height * kResolution,
                       random.uniform(-3.0, 3.0)};
      const Plan& plan = p.plan(costs, start, goal);
      if (!plan.ok()) {
        EXPECT_TRUE(plan.path.empty());
        EXPECT_FALSE(plan.reason.empty());
        continue;
      }
      const auto escape = static_cast<std::size_t>(std::ceil(plan.escape_distance / kResolution));
      expect_safe(plan, costs, escape);
      if (HasFatalFailure()) return;
      EXPECT_DOUBLE_EQ(plan.path.back().yaw, goal.yaw);
      ++planned;
    }
  }
  EXPECT_GT(planned, 500);
}

TEST(GridPlanner, KeepsAwayFromWallsThatCost) {
  // Two ways of equal length around a block; the upper one is costly.
  CostGrid costs = room(60, 60);
  fill(costs, 20, 20, 40, 40, grid::kLethalCost);
  fill(costs, 0, 41, 59, 59, 200);
  GridPlanner inflated = planner();
  const Plan& plan = inflated.plan(costs, at(costs, 5, 30), at(costs, 55, 30));
  ASSERT_TRUE(plan.ok());
  for (const Pose2& pose : plan.path)
    EXPECT_LT(costs.at(costs.geometry().cell_at(pose.x, pose.y)), 200);
  expect_safe(plan, costs);
}

TEST(GridPlanner, TurnsRoundly) {
  CostGrid costs = room(80, 80);
  fill(costs, 30, 0, 49, 59, grid::kLethalCost);
  GridPlanner p = planner();
  const Plan& plan = p.plan(costs, at(costs, 10, 10), at(costs, 70, 10, -1.5));
  ASSERT_TRUE(plan.ok());
  expect_safe(plan, costs);
  for (std::size_t i = 1; i + 1 < plan.path.size(); ++i)
    EXPECT_LT(std::abs(geometry::shortest_turn(plan.path[i - 1].yaw, plan.path[i].yaw)), 1.0) << i;
  GridPlanner grid = planner({.refine = false});
  EXPECT_LT(plan.length, grid.plan(costs, at(costs, 10, 10), at(costs, 70, 10)).length);
}

TEST(GridPlanner, DoesNotSlipBetweenDiagonalObstacles) {
  CostGrid costs = room(40, 40);
  for (int i = 0; i < 40; ++i) costs.at({i, 39 - i}) = grid::kLethalCost;
  GridPlanner p = planner({.goal_tolerance = 0.0});
  EXPECT_EQ(p.plan(costs, at(costs, 5, 5), at(costs, 35, 35)).failure, PlanFailure::kDisconnected);
}

TEST(GridPlanner, EscapesFromAnInscribedCell) {
  CostGrid costs = room(60, 40);
  fill(costs, 0, 0, 59, 6, grid::kInscribedCost);
  fill(costs, 0, 0, 59, 2, grid::kLethalCost);
  GridPlanner p = planner({.escape_radius = 0.4});
  const Plan& plan = p.plan(costs, at(costs, 20, 4), at(costs, 50, 30));
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_NEAR(plan.escape_distance, 3 * kResolution, 1e-9);
  EXPECT_EQ(plan.path.front().position(), at(costs, 20, 4).position());
  expect_safe(plan, costs, 3);
}

TEST(GridPlanner, DoesNotEscapeThroughAWallOrTooFar) {
  CostGrid costs = room(60, 40);
  fill(costs, 0, 0, 59, 20, grid::kInscribedCost);
  fill(costs, 0, 6, 59, 6, grid::kLethalCost);
  GridPlanner p = planner({.escape_radius = 5.0});
  const Plan& through_wall = p.plan(costs, at(costs, 20, 4), at(costs, 50, 30));
  EXPECT_EQ(through_wall.failure, PlanFailure::kStartBlocked);
  EXPECT_EQ(
      through_wall.reason,
      "start (0.03, 2.23) m is blocked (cost 253) and no free cell can be reached within 5.00 m");
  GridPlanner near = planner({.escape_radius = 0.3});
  EXPECT_EQ(near.plan(costs, at(costs, 20, 14), at(costs, 50, 30)).failure,
            PlanFailure::kStartBlocked);
  EXPECT_TRUE(near.plan(costs, at(costs, 20, 15), at(costs, 50, 30)).ok());
}

TEST(GridPlanner, EndsNearAGoalInAnObstacle) {
  CostGrid costs = room(60, 40);
  fill(costs, 40, 10, 50, 20, grid::kInscribedCost);
  GridPlanner p = planner({.goal_tolerance = 0.2});
  const Plan& plan = p.plan(costs, at(costs, 5, 15), at(costs, 42, 15, 0.7));
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_NEAR(plan.goal_shift, 3 * kResolution, 1e-9);
  EXPECT_NEAR(plan.path.back().x, at(costs, 39, 15).x, 1e-9);
  EXPECT_DOUBLE_EQ(plan.path.back().yaw, 0.7);
  const Plan& blocked = p.plan(costs, at(costs, 5, 15), at(costs, 45, 15));
  EXPECT_EQ(blocked.failure, PlanFailure::kGoalBlocked);
  EXPECT_EQ(blocked.reason,
            "goal (1.27, 2.77) m is blocked (cost 253) and no free cell is within 0.20 m");
}

TEST(GridPlanner, PrefersAReachableCellToANearerOneBehindAWall) {
  // The goal lies in a wall; the nearest free cell is in a closed room behind it.
  CostGrid costs = room(60, 40);
  fill(costs, 40, 0, 45, 39, grid::kLethalCost);
  for (const Metric metric : {Metric::kInflated, Metric::kShortest}) {
    for (const Algorithm algorithm : {Algorithm::kDijkstra, Algorithm::kAstar}) {
      GridPlanner p = planner({.algorithm = algorithm, .metric = metric, .goal_tolerance = 0.3});
      const Plan& plan = p.plan(costs, at(costs, 5, 15), at(costs, 44, 15));
      ASSERT_TRUE(plan.ok()) << plan.reason;
      EXPECT_NEAR(plan.path.back().x, at(costs, 39, 15).x, 1e-9);
      EXPECT_NEAR(plan.goal_shift, 5 * kResolution, 1e-9);
      const Plan& closed = p.plan(costs, at(costs, 5, 15), at(costs, 55, 15));
      EXPECT_EQ(closed.failure, PlanFailure::kDisconnected);
      EXPECT_EQ(closed.reason, "no path joins start (-0.72, 2.77) m and goal (1.78, 2.77) m");
    }
  }
}

TEST(GridPlanner, CrossesUnknownCellsOnlyWhenAllowed) {
  CostGrid costs = room(60, 40);
  fill(costs, 30, 0, 32, 39, grid::kUnknownCost);
  GridPlanner strict = planner();
  EXPECT_EQ(strict.plan(costs, at(costs, 5, 5), at(costs, 55, 5)).failure,
            PlanFailure::kDisconnected);
  GridPlanner open = planner({.allow_unknown = true});
  EXPECT_TRUE(open.plan(costs, at(costs, 5, 5), at(costs, 55, 5)).ok());
  fill(costs, 30, 10, 32, 10, 0);
  GridPlanner wary = planner({.allow_unknown = true, .unknown_cost = 252});
  const Plan& plan = wary.plan(costs, at(costs, 5, 8), at(costs, 55, 8));
  ASSERT_TRUE(plan.ok());
  for (const Pose2& pose : plan.path)
    EXPECT_NE(costs.at(costs.geometry().cell_at(pose.x, pose.y)), grid::kUnknownCost);
}

TEST(GridPlanner, AnswersBadInputWithAReason) {
  const CostGrid costs = room(60, 40);
  GridPlanner p = planner();
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(p.plan(costs, {nan, 3.0, 0.0}, at(costs, 1, 1)).failure, PlanFailure::kBadInput);
  EXPECT_EQ(p.plan(costs, at(costs, 1, 1), {0.0, infinity, 0.0}).failure, PlanFailure::kBadInput);
  EXPECT_EQ(p.plan(costs, at(costs, 1, 1), {0.0, 3.0, nan}).failure, PlanFailure::kBadInput);
  EXPECT_EQ(p.plan(CostGrid{}, at(costs, 1, 1), at(costs, 2, 2)).failure, PlanFailure::kBadInput);
  CostGrid no_resolution({.width = 3, .height = 3, .resolution = 0.0});
  EXPECT_EQ(p.plan(no_resolution, {}, {}).failure, PlanFailure::kBadInput);
  EXPECT_NE(p.plan(no_resolution, {}, {}).reason.find("3 x 3 cells of 0 m"), std::string::npos);
  EXPECT_EQ(p.plan(costs, {1e300, 0.0, 0.0}, at(costs, 1, 1)).failure, PlanFailure::kStartOutside);
  const Plan& outside = p.plan(costs, at(costs, 1, 1), {0.0, 1.99, 0.0});
  EXPECT_EQ(outside.failure, PlanFailure::kGoalOutside);
  EXPECT_EQ(outside.reason,
            "goal (0.00, 1.99) m is outside the map, which spans (-1.00, 2.00) to (2.00, 4.00) m");
  EXPECT_TRUE(p.plan(costs, at(costs, 1, 1), at(costs, 2, 2)).ok());
}

TEST(GridPlanner, EveryFailureHasAName) {
  for (int i = 0; i <= static_cast<int>(PlanFailure::kTooLong); ++i)
    EXPECT_STRNE(name(static_cast<PlanFailure>(i)), "unknown");
}

TEST(GridPlanner, StaysWhereItIsWhenTheGoalIsTheStart) {
  const CostGrid costs = room(60, 40);
  GridPlanner p = planner();
  const Plan& plan = p.plan(costs, at(costs, 5, 5), at(costs, 5, 5, 2.0));
  ASSERT_TRUE(plan.ok());
  ASSERT_EQ(plan.path.size(), 1u);
  EXPECT_EQ(plan.path[0], at(costs, 5, 5, 2.0));
  EXPECT_EQ(plan.length, 0.0);
}

TEST(GridPlanner, TakesMapsOfChangingSize) {
  GridPlanner p = planner();
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 40}, {254, 3}, {1022, 5}, {20, 20}, {1, 1}}) {
    const CostGrid costs = room(width, height);
    const Plan& plan = p.plan(costs, at(costs, 0, 0), at(costs, width - 1, height - 1));
    ASSERT_TRUE(plan.ok()) << plan.reason;
    expect_safe(plan, costs);
  }
}

TEST(GridPlanner, DoesNotAllocateAfterTheFirstQueryOnAMap) {
  Random random(5);
  CostGrid costs = room(200, 200);
  for (auto& cost : costs)
    cost = static_cast<std::uint8_t>(random.uniform() < 0.1 ? grid::kLethalCost
                                                            : random.below(grid::kInscribedCost));
  costs.at({0, 0}) = costs.at({199, 199}) = 0;
  for (const Metric metric : {Metric::kInflated, Metric::kShortest}) {
    GridPlanner p = planner({.metric = metric});
    ASSERT_TRUE(p.plan(costs, at(costs, 0, 0), at(costs, 199, 199)).ok());
    const std::uint64_t before = test::allocation_count();
    int planned = 0;
    for (int i = 0; i < 100; ++i) {
      const Pose2 goal =
          at(costs, static_cast<int>(random.below(150)), static_cast<int>(random.below(150)));
      planned += p.plan(costs, at(costs, 0, 0), goal).ok() ? 1 : 0;
    }
    EXPECT_EQ(test::allocation_count() - before, 0U);
    EXPECT_GT(planned, 90);
  }
}

}  // namespace
}  // namespace usher::global_planner
