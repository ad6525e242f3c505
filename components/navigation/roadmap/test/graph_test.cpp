#include "navigation/roadmap/core/graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "foundation/grid/sampling.hpp"
#include "foundation/grid/test/rooms.hpp"
#include "navigation/roadmap/core/graph_search.hpp"

namespace usher::roadmap {
namespace {

using namespace grid;

struct Made {
  grid::OccupancyGrid map;
  FreeSpace space;
  Graph graph;
};

Made make(const grid::OccupancyGrid& map, Connection connection, std::uint64_t seed,
          Sampling sampling = Sampling::kCell) {
  Made made{map, {}, {}};
  made.space.build(map, 0.24);
  Random random(seed);
  std::vector<Point2> points;
  sample_points(made.space, map, {.sampling = sampling}, random, points);
  made.graph.reset(points);
  made.graph.connect(made.space, {.connection = connection}, random);
  return made;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> edges(const Graph& graph) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> all;
  for (std::uint32_t v = 0; v < graph.size(); ++v) {
    for (auto at = graph.first_link(v); at != Graph::kNone; at = graph.link(at).next) {
      if (graph.usable(graph.link(at))) all.emplace(v, graph.link(at).to);
    }
  }
  return all;
}

TEST(Sampling, PutsEveryVertexIntoFreeSpace) {
  const auto map = clutter(1);
  FreeSpace space;
  space.build(map, 0.24);
  for (const auto sampling :
       {Sampling::kRandom, Sampling::kGrid, Sampling::kCell, Sampling::kMedialAxis}) {
    Random random(1);
    std::vector<Point2> points;
    sample_points(space, map, {.sampling = sampling}, random, points);
    EXPECT_GT(points.size(), 50U);
    for (const auto& point : points) ASSERT_TRUE(space.free(point));
  }
}

TEST(Sampling, CellsGiveEveryFreeSquareItsPoints) {
  const auto map = two_rooms();
  FreeSpace space;
  space.build(map, 0.24);
  Random random(1);
  std::vector<Point2> points;
  sample_points(space, map, {.sampling = Sampling::kCell, .cell_size = 1.0, .points_per_cell = 3},
                random, points);
  // The corridor is 0.7 m wide: 0.2 m are left of it in squares of its own.
  const auto in_corridor = std::count_if(points.begin(), points.end(), [](const Point2& p) {
    return p.x() > 16.0 && p.x() < 19.0 && p.y() > 4.0 && p.y() < 4.7;
  });
  EXPECT_EQ(in_corridor, 9);
}

TEST(Sampling, TheMedialAxisIsAsFarFromBothWalls) {
  const auto map = two_rooms();
  FreeSpace space;
  space.build(map, 0.24);
  Random random(1);
  std::vector<Point2> points;
  sample_points(space, map, {.sampling = Sampling::kMedialAxis}, random, points);
  int in_corridor = 0;
  for (const auto& p : points) {
    if (p.x() < 16.0 || p.x() > 19.0 || p.y() < 4.0 || p.y() > 4.7) continue;
    EXPECT_NEAR(p.y(), 4.35, 0.06);
    ++in_corridor;
  }
  EXPECT_GT(in_corridor, 3);
}

TEST(Graph, FindsTheNearestVerticesInOrder) {
  Random random(4);
  std::vector<Point2> points;
  for (int i = 0; i < 700; ++i) points.emplace_back(random.uniform(0, 30), random.uniform(0, 3));
  Graph graph;
  graph.reset(points);
  for (int i = 0; i < 200; ++i) {
    const Point2 from(random.uniform(-10, 40), random.uniform(-10, 10));
    std::vector<Graph::Candidate> found;
    graph.nearest(from, 20, random.uniform(0.01, 10), found);
    std::vector<double> distances;
    for (const auto& p : points) distances.push_back((p - from).norm());
    std::sort(distances.begin(), distances.end());
    ASSERT_EQ(found.size(), 20U);
    for (std::size_t k = 0; k < found.size(); ++k)
      ASSERT_NEAR((graph.vertex(found[k].vertex) - from).norm(), distances[k], 1e-4);
  }
  std::vector<Graph::Candidate> found;
  graph.nearest({0, 0}, 10000, 1.0, found);
  EXPECT_EQ(found.size(), 700U);
}

TEST(Graph, EveryEdgeIsAFreeLineAndGoesBothWays) {
  for (const auto connection :
       {Connection::kNearest, Connection::kThreshold, Connection::kNeighborhood}) {
    const Made made = make(clutter(5), connection, 5);
    const auto all = edges(made.graph);
    EXPECT_GT(all.size(), 500U);
    for (const auto& [a, b] : all) {
      ASSERT_TRUE(all.contains({b, a}));
      ASSERT_NE(a, b);
      // A touched corner may count from one side only.
      ASSERT_TRUE(made.space.line_free(made.graph.vertex(a), made.graph.vertex(b)) ||
                  made.space.line_free(made.graph.vertex(b), made.graph.vertex(a)));
    }
  }
}

TEST(Graph, JoinsEveryVertexToTheNearestThatItSees) {
  const Made made = make(clutter(6), Connection::kNeighborhood, 6);
  std::vector<Graph::Candidate> found;
  for (std::uint32_t v = 0; v < made.graph.size(); ++v) {
    made.graph.nearest(made.graph.vertex(v), 2, 1.0, found);
    const std::uint32_t n = found.back().vertex;
    if (made.space.line_free(made.graph.vertex(v), made.graph.vertex(n))) {
      EXPECT_NE(made.graph.first_link(v), Graph::kNone) << v;
    }
  }
}

TEST(Graph, ClosesWhatAnObstacleTouchesAndOpensItAgain) {
  Made made = make(two_rooms(), Connection::kNeighborhood, 7);
  const auto before = edges(made.graph);
  auto map = made.map;
  block(map, 4.0, 4.0, 5.0, 5.0);
  FreeSpace now;
  now.build(map, 0.24);
  Random random(1);
  made.graph.update(now, {{3.7, 3.7}, {5.3, 5.3}}, {}, random);
  const auto during = edges(made.graph);
  EXPECT_NE(before, during);
  for (const auto& [a, b] : during)
    ASSERT_TRUE(now.line_free(made.graph.vertex(a), made.graph.vertex(b)) ||
                now.line_free(made.graph.vertex(b), made.graph.vertex(a)));
  made.graph.restore();
  EXPECT_EQ(edges(made.graph), before);
}

TEST(GraphSearch, BothSearchesFindTheShortestWay) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Made made = make(clutter(seed), Connection::kNeighborhood, seed);
    // Textbook Bellman-Ford from vertex 0.
    std::vector<double> best(made.graph.size(), std::numeric_limits<double>::infinity());
    best[0] = 0.0;
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& [a, b] : edges(made.graph)) {
        const double cost = best[a] + (made.graph.vertex(a) - made.graph.vertex(b)).norm();
        if (cost < best[b] - 1e-9) best[b] = cost, changed = true;
      }
    }
    GraphSearch search;
    Random random(seed);
    for (int i = 0; i < 50; ++i) {
      if (i == 25) search.prepare(made.graph);  // with landmarks from here on
      const auto to = static_cast<std::uint32_t>(random.below(made.graph.size()));
      const Graph::Candidate start{0.0F, 0}, goal{0.0F, to};
      for (const bool informed : {false, true}) {
        const auto way = search.run({made.graph,
                                     made.graph.vertex(0),
                                     made.graph.vertex(to),
                                     {&start, 1},
                                     {&goal, 1},
                                     informed});
        ASSERT_EQ(way.has_value(), std::isfinite(best[to]));
        if (!way) continue;
        EXPECT_NEAR(search.length(), best[to], 1e-3) << seed << " " << to;
        EXPECT_EQ(way->front(), 0U);
        EXPECT_EQ(way->back(), to);
      }
    }
  }
}

}  // namespace
}  // namespace usher::roadmap
