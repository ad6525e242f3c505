// Figures of the roadmap on the Willow map, beside OMPL's PRM on the same free space: obstacles
// grown by 0.3 m, the part that hangs together with the cell (470, 405), 5000 vertices drawn
// anywhere, and those of the 50 queries whose ends are free.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "foundation/grid/map_file.hpp"
#include "navigation/roadmap/core/path_smoother.hpp"
#include "navigation/roadmap/core/roadmap_planner.hpp"
#include "support/bench.hpp"

namespace {

using namespace usher::roadmap;
using usher::grid::Cell;
using usher::grid::OccupancyGrid;

constexpr double kInflation = 0.3;
constexpr double kSquare = 0.65;  // [m] two vertices in each
constexpr int kVertices = 5000;

OccupancyGrid read_map(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  const auto image = usher::grid::decode_map_image(bytes, path);
  if (!image) return {};
  usher::grid::MapDescription description;
  description.resolution = 0.05;
  description.occupied_threshold = 0.65;
  description.free_threshold = 0.196;
  auto map = usher::grid::to_occupancy(*image, description);
  for (auto& value : map) value = value == usher::grid::kFree ? value : usher::grid::kOccupied;
  return map;
}

/// Everything that does not hang together with `seed` becomes unknown.
void keep_component(OccupancyGrid& map, Cell seed) {
  FreeSpace space;
  space.build(map, kInflation);
  std::vector<bool> kept(map.size(), false);
  std::vector<Cell> open{seed};
  kept[map.geometry().index(seed)] = true;
  while (!open.empty()) {
    const Cell c = open.back();
    open.pop_back();
    for (const Cell n :
         {Cell{c.x + 1, c.y}, Cell{c.x - 1, c.y}, Cell{c.x, c.y + 1}, Cell{c.x, c.y - 1}}) {
      if (!space.free(n) || kept[map.geometry().index(n)]) continue;
      kept[map.geometry().index(n)] = true;
      open.push_back(n);
    }
  }
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (!kept[i] && space.free(map.geometry().cell(i))) map[i] = usher::grid::kUnknown;
  }
}

struct Query {
  Point2 start, goal;
};

std::vector<Query> read_queries(const std::string& path, const OccupancyGrid& map) {
  FreeSpace space;
  space.build(map, kInflation);
  std::vector<Query> queries;
  std::ifstream file(path);
  for (Cell a, b; file >> a.x >> a.y >> b.x >> b.y;) {
    if (space.free(a) && space.free(b))
      queries.push_back({map.geometry().center(a), map.geometry().center(b)});
  }
  return queries;
}

RoadmapConfig config(Search search) {
  RoadmapConfig c;
  c.inflation = kInflation;
  c.sampling.cell_size = kSquare;
  c.sampling.points_per_cell = 2;
  c.search = search;
  c.regenerations = 0;
  return c;
}

class Workload {
 public:
  Workload(const RoadmapConfig& config, const OccupancyGrid& map, const std::vector<Query>& queries)
      : planner_(*RoadmapPlanner::create(config, 1)), queries_(queries) {
    if (!map.empty() && !planner_.set_map(map)) std::abort();
  }
  void run() {
    solved_ = 0;
    length_ = 0.0;
    for (const Query& q : queries_) {
      const Route& route = planner_.plan(q.start, q.goal);
      solved_ += route.found ? 1 : 0;
      length_ += route.length;
    }
  }
  int solved() const { return solved_; }
  double length() const { return length_; }
  const RoadmapPlanner& planner() const { return planner_; }

 private:
  RoadmapPlanner planner_;
  const std::vector<Query>& queries_;
  int solved_ = 0;
  double length_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  using usher::bench::Bound;
  usher::bench::Bench bench("roadmap", "willow-1000x1000, grown by 0.3 m, 5000 vertices");
  OccupancyGrid map = read_map(bench.data("peers/willow-1000x1000-0.05.pgm"));
  const std::string queries_file = bench.data("peers/willow-1000-queries.txt");
  if (map.empty()) return bench.run(argc, argv);
  keep_component(map, {470, 405});
  const auto queries = read_queries(queries_file, map);

  FreeSpace space;
  bench.time("grow_obstacles_ms", 1e-3, [&] { space.build(map, kInflation); });

  const RoadmapConfig defaults = config(Search::kAstar);
  std::vector<Point2> points;
  Graph graph;
  GraphSearch search;
  const auto build = [&] {
    usher::Random random(1);
    sample_points(space, map, defaults.sampling, random, points);
    graph.reset(points);
    graph.connect(space, defaults.connection, random);
    search.prepare(graph);
  };
  space.build(map, kInflation);
  bench.time("build_s", 1.0, build);
  bench.target("build_s", Bound::kAtMost, 0.03);
  bench.published("build_s", 0.030, "OMPL PRM");
  bench.published("build_s", 0.069, "OMPL PRM*");
  bench.instructions("build_instructions", build);
  bench.published("build_instructions", 259.3e6, "OMPL PRM");

  Workload dijkstra(config(Search::kDijkstra), map, queries);
  Workload astar(config(Search::kAstar), map, queries);
  const double mean_ms = 1e-3 * static_cast<double>(queries.size());
  bench.time("query_dijkstra_ms", mean_ms, [&] { dijkstra.run(); });
  bench.time("query_astar_ms", mean_ms, [&] { astar.run(); });
  bench.target("query_astar_ms", Bound::kAtMost, 0.2);
  for (const char* key : {"query_dijkstra_ms", "query_astar_ms"}) {
    bench.published(key, 0.827, "OMPL PRM, connect and A* only");
    bench.published(key, 16.0, "OMPL PRM::solve");
    bench.published(key, 964.0, "meeting report");
  }
  bench.instructions("query_astar_instructions", [&] { astar.run(); });
  bench.published("query_astar_instructions", 1.68e6 * 40, "OMPL PRM");

  bench.metric("free_cells", [&] {
    double count = 0.0;
    for (std::size_t i = 0; i < map.size(); ++i)
      count += space.free(map.geometry().cell(i)) ? 1 : 0;
    return count;
  });
  bench.published("free_cells", 285835, "OMPL's table");
  bench.metric("vertices", [&] { return static_cast<double>(graph.size()); });
  bench.target("vertices", Bound::kAtLeast, kVertices);
  bench.metric("edges", [&] { return static_cast<double>(graph.edge_count()); });
  bench.published("edges", 39358, "OMPL PRM");
  bench.metric("queries", [&] { return static_cast<double>(queries.size()); });
  bench.metric("solved", [&] { return static_cast<double>(astar.solved()); });
  bench.published("solved", 39, "OMPL PRM");
  bench.target("solved", Bound::kAtLeast, 40);
  bench.metric("length_m", [&] { return astar.length(); });
  bench.published("length_m", 1168.0, "OMPL PRM, simplified");
  return bench.run(argc, argv);
}
