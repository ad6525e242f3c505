#include <gtest/gtest.h>

#include <cmath>

#include "foundation/grid/test/rooms.hpp"
#include "navigation/roadmap/core/new_obstacles.hpp"
#include "navigation/roadmap/core/path_smoother.hpp"
#include "navigation/roadmap/core/roadmap_planner.hpp"

namespace usher::roadmap {
namespace {

using namespace grid;

RoadmapPlanner planner(const grid::OccupancyGrid& map, RoadmapConfig config = {},
                       std::uint64_t seed = 1) {
  auto made = RoadmapPlanner::create(config, seed);
  EXPECT_TRUE(made.ok());
  EXPECT_TRUE(made->set_map(map).ok());
  return std::move(made).value();
}

void expect_free(const RoadmapPlanner& planner, const Route& route) {
  for (std::size_t i = 1; i < route.way_points.size(); ++i)
    EXPECT_TRUE(planner.space().line_free(route.way_points[i - 1], route.way_points[i]));
}

std::vector<Point2> closed_door() {
  std::vector<Point2> things;
  for (double y = 4.6; y < 5.4; y += 0.05) things.emplace_back(10.0, y);
  return things;
}

TEST(RoadmapPlanner, GoesThroughTheDoorHardlyFartherThanNeeded) {
  for (const auto sampling : {Sampling::kCell, Sampling::kMedialAxis}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      auto p = planner(two_rooms(), {.sampling = {.sampling = sampling}}, seed);
      const Route& route = p.plan({2, 2}, {12, 9});
      ASSERT_TRUE(route.found) << route.reason;
      expect_free(p, route);
      EXPECT_EQ(route.way_points.front(), Point2(2, 2));
      EXPECT_EQ(route.way_points.back(), Point2(12, 9));
      const double through_door = std::hypot(8.0, 3.0) + std::hypot(2.0, 4.0);
      EXPECT_LT(route.length, 1.03 * through_door);
    }
  }
}

TEST(RoadmapPlanner, ReachesTheEndOfANarrowCorridorByCellAndMedialAxis) {
  for (const auto sampling : {Sampling::kCell, Sampling::kMedialAxis}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      auto p = planner(two_rooms(), {.sampling = {.sampling = sampling}, .regenerations = 0}, seed);
      EXPECT_TRUE(p.plan({2, 8}, {19.3, 4.35}).found) << seed;
    }
  }
}

TEST(RoadmapPlanner, AnObstacleClosesTheWayUntilItGoes) {
  auto map = two_rooms();
  for (int y = 20; y < 40; ++y) map.at({198, y}) = map.at({199, y}) = grid::kFree;
  block(map, 9.9, 1.0, 10.1, 2.0);  // whole again
  for (int y = 20; y < 40; ++y)
    for (int x = 198; x < 203; ++x) map.at({x, y}) = grid::kFree;  // a second door, at y = 1..2
  auto p = planner(map);
  const double direct = p.plan({8, 5}, {12, 5}).length;
  EXPECT_LT(direct, 4.2);
  EXPECT_TRUE(p.set_obstacles(closed_door()));
  EXPECT_FALSE(p.set_obstacles(closed_door())) << "the same things again";
  const Route& around = p.plan({8, 5}, {12, 5});
  ASSERT_TRUE(around.found) << around.reason;
  expect_free(p, around);
  EXPECT_GT(around.length, 7.0);
  EXPECT_TRUE(p.set_obstacles({}));
  EXPECT_NEAR(p.plan({8, 5}, {12, 5}).length, direct, 0.05);
}

TEST(RoadmapPlanner, SaysThatThereIsNoPathAfterItsRegenerations) {
  auto p = planner(two_rooms(), {.regenerations = 2});
  p.set_obstacles(closed_door());
  const Route& none = p.plan({2, 2}, {12, 9});
  EXPECT_FALSE(none.found);
  EXPECT_EQ(none.regenerations, 2);
  EXPECT_NE(none.reason.find("after 2 new roadmaps"), std::string::npos) << none.reason;
  EXPECT_TRUE(none.way_points.empty());
  p.set_obstacles({});
  EXPECT_TRUE(p.plan({2, 2}, {12, 9}).found);
}

TEST(RoadmapPlanner, RegenerationFindsWhatTooFewVerticesMissed) {
  int regenerated = 0, solved = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    auto p = planner(
        two_rooms(),
        {.sampling = {.sampling = Sampling::kRandom, .random_points = 25}, .regenerations = 20},
        seed);
    const Route& route = p.plan({2, 2}, {12, 9});
    regenerated += route.regenerations > 0 ? 1 : 0;
    solved += route.found ? 1 : 0;
  }
  EXPECT_EQ(solved, 20);
  EXPECT_GT(regenerated, 0);
}

TEST(RoadmapPlanner, LeavesABlockedStartAndStopsBesideABlockedGoal) {
  auto p = planner(two_rooms());
  const Route& route = p.plan({2.0, 0.2}, {12.0, 9.85});
  ASSERT_TRUE(route.found) << route.reason;
  EXPECT_EQ(route.way_points.front(), Point2(2.0, 0.2));
  EXPECT_GT(route.goal_shift, 0.05);
  EXPECT_LT(route.goal_shift, 0.3);
  EXPECT_FALSE(p.plan({2, 2}, {17.0, 3.0}).found);
}

TEST(RoadmapPlanner, AnswersNonsenseWithAReason) {
  auto p = planner(two_rooms());
  EXPECT_FALSE(p.plan({std::nan(""), 1}, {2, 2}).found);
  EXPECT_FALSE(p.plan({1, 1}, {INFINITY, 2}).found);
  EXPECT_NE(p.plan({1, 1}, {99, 2}).reason.find("outside the map"), std::string::npos);
  EXPECT_FALSE(p.set_obstacles(std::vector<Point2>{{std::nan(""), 1}, {1e300, 2}, {-5, 2}}));
  RoadmapConfig wrong;
  wrong.inflation = -1.0;
  EXPECT_EQ(RoadmapPlanner::create(wrong, 1).error(), "inflation must be in [0.01, 2], got -1");
  auto empty = std::move(RoadmapPlanner::create({}, 1)).value();
  EXPECT_FALSE(empty.set_map({}).ok());
  EXPECT_EQ(empty.plan({1, 1}, {2, 2}).reason, "no map");
  grid::OccupancyGrid solid({.width = 50, .height = 50, .resolution = 0.05}, grid::kOccupied);
  EXPECT_FALSE(empty.set_map(solid).ok());
}

TEST(RoadmapPlanner, SameSeedSamePath) {
  auto a = planner(clutter(3), {}, 9), b = planner(clutter(3), {}, 9);
  EXPECT_EQ(a.plan({1, 1}, {19, 9}).way_points, b.plan({1, 1}, {19, 9}).way_points);
}

TEST(PathSmoother, NeverMakesAPathLongerOrBlocked) {
  FreeSpace space;
  space.build(clutter(8), 0.24);
  auto p = planner(clutter(8), {.smoothing_passes = 0, .tightening_passes = 0}, 8);
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const Route& route = p.plan({random.uniform(0.5, 19), random.uniform(0.5, 9)},
                                {random.uniform(0.5, 19), random.uniform(0.5, 9)});
    if (!route.found || route.goal_shift > 0.0 || !space.free(route.way_points.front())) continue;
    auto path = route.way_points;
    const double raw = length(path);
    smooth(space, 10, path);
    const double smoothed = length(path);
    EXPECT_LE(smoothed, raw + 1e-9);
    tighten(space, 3, path);
    EXPECT_LE(length(path), smoothed + 1e-9);
    for (std::size_t k = 1; k < path.size(); ++k)
      ASSERT_TRUE(space.line_free(path[k - 1], path[k]));
  }
}

TEST(NewObstacles, AreNearTheRobotAndNotInTheMap) {
  const auto map = two_rooms();
  grid::DistanceField distances;
  distances.build(map, 0.3);
  grid::Grid<std::uint8_t> costs(map.geometry(), 0);
  const auto mark = [&](double x, double y) { costs.at(map.geometry().cell_at(x, y)) = 254; };
  mark(5.0, 5.0);   // new
  mark(10.0, 3.0);  // the map's wall
  mark(9.8, 3.0);   // beside it, within the tolerance
  mark(9.0, 5.0);   // new but far
  std::vector<Point2> found;
  new_obstacles(costs, distances, {4.0, 5.0}, 4.0, 0.15, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].x(), 5.0, 0.05);
}

TEST(Poses, AreDenseAndLookAlongTheWay) {
  const auto poses = to_poses({{0, 0}, {1, 0}, {1, 1}}, 0.05, 2.0);
  for (std::size_t i = 1; i < poses.size(); ++i)
    EXPECT_LE(geometry::distance(poses[i - 1], poses[i]), 0.05 + 1e-9);
  EXPECT_EQ(poses.front().yaw, 0.0);
  EXPECT_EQ(poses.back(), (geometry::Pose2{1, 1, 2.0}));
  EXPECT_TRUE(to_poses({}, 0.05, 0.0).empty());
}

}  // namespace
}  // namespace usher::roadmap
