// Figures of the global planner on the 50 Willow queries. One query = everything from the costmap
// to the refined path.
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <vector>

#include "navigation/global_planner/core/grid_planner.hpp"
#include "support/bench.hpp"

namespace {

using usher::geometry::Pose2;
using namespace usher::global_planner;

struct Query {
  usher::grid::Cell start, goal;
};

CostGrid read_costs(const std::string& path) {
  CostGrid costs({.width = 1000, .height = 1000, .resolution = 0.05});
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(costs.data()), static_cast<std::streamsize>(costs.size()));
  return file.gcount() == static_cast<std::streamsize>(costs.size()) ? costs : CostGrid{};
}

std::vector<Query> read_queries(const std::string& path) {
  std::vector<Query> queries;
  std::ifstream file(path);
  for (Query q; file >> q.start.x >> q.start.y >> q.goal.x >> q.goal.y;) queries.push_back(q);
  return queries;
}

/// Length of the shortest 8-connected path over cells below usher::grid::kInscribedCost without
/// corner cutting, by a plain textbook Dijkstra that shares nothing with the planner.
double octile_optimum(const CostGrid& costs, const Query& query) {
  std::vector<double> best(costs.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto& g = costs.geometry();
  const auto free = [&](int x, int y) {
    return costs.value_or({x, y}, usher::grid::kLethalCost) < usher::grid::kInscribedCost;
  };
  best[g.index(query.start)] = 0.0;
  open.emplace(0.0, g.index(query.start));
  while (!open.empty()) {
    const auto [length, index] = open.top();
    open.pop();
    if (index == g.index(query.goal)) return length * costs.resolution();
    if (length > best[index]) continue;
    const auto c = g.cell(index);
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (!free(c.x + dx, c.y + dy) || !free(c.x + dx, c.y) || !free(c.x, c.y + dy)) continue;
        const std::size_t to = g.index({c.x + dx, c.y + dy});
        const double total = length + std::hypot(dx, dy);
        if (total < best[to]) best[to] = total, open.emplace(total, to);
      }
    }
  }
  return std::nan("");
}

class Workload {
 public:
  Workload(const CostGrid& costs, const std::vector<Query>& queries, Algorithm algorithm,
           Metric metric)
      : costs_(costs),
        queries_(queries),
        planner_(*GridPlanner::create({.algorithm = algorithm, .metric = metric})) {}

  /// All queries; sums up lengths and failures.
  void run() {
    length_ = 0.0;
    failed_ = 0;
    for (const Query& q : queries_) run(q);
  }
  void run(const Query& q) {
    const auto start = costs_.geometry().center(q.start);
    const auto goal = costs_.geometry().center(q.goal);
    const Plan& plan =
        planner_.plan(costs_, {start.x(), start.y(), 0.0}, {goal.x(), goal.y(), 0.0});
    length_ += plan.length;
    failed_ += plan.ok() ? 0 : 1;
  }
  double length() const { return length_; }
  int failed() const { return failed_; }

 private:
  const CostGrid& costs_;
  const std::vector<Query>& queries_;
  GridPlanner planner_;
  double length_ = 0.0;
  int failed_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  usher::bench::Bench bench(
      "global_planner",
      "willow-1000-costmap-0.55, 50 queries, mean over the queries of each one's least time");
  const CostGrid costs = read_costs(bench.data("peers/willow-1000-costmap-0.55.raw"));
  const std::vector<Query> queries = read_queries(bench.data("peers/willow-1000-queries.txt"));
  if (costs.empty() || queries.empty()) return bench.run(argc, argv);

  Workload dijkstra(costs, queries, Algorithm::kDijkstra, Metric::kInflated);
  Workload astar(costs, queries, Algorithm::kAstar, Metric::kInflated);
  Workload dijkstra_uniform(costs, queries, Algorithm::kDijkstra, Metric::kShortest);
  Workload astar_uniform(costs, queries, Algorithm::kAstar, Metric::kShortest);

  using usher::bench::Bound;
  const auto time = [&](const char* key, Workload& workload, double at_most) {
    bench.time_each(key, 1e-3, queries.size(), [&](std::size_t i) { workload.run(queries[i]); });
    bench.target(key, Bound::kAtMost, at_most);
  };
  time("dijkstra_mean_ms", dijkstra, 3.5);
  time("astar_mean_ms", astar, 1.2);
  time("dijkstra_uniform_mean_ms", dijkstra_uniform, 2.0);
  time("astar_uniform_mean_ms", astar_uniform, 0.8);
  bench.published("dijkstra_mean_ms", 8.5, "navfn");
  bench.published("dijkstra_mean_ms", 11.9, "ROS global_planner");
  bench.published("astar_mean_ms", 4.4, "navfn");
  bench.published("astar_mean_ms", 3.3, "ROS global_planner");

  // The peers' mean without the query that one of them floods the map for.
  const std::array<Query, 5> sample = {queries[0], queries[10], queries[5], queries[30],
                                       queries[40]};
  const auto count = [&](const char* key, Workload& workload) {
    bench.instructions(key, [&] {
      for (const Query& q : sample) workload.run(q);
    });
  };
  count("dijkstra_instructions_of_5", dijkstra);
  count("astar_instructions_of_5", astar);
  bench.published("dijkstra_instructions_of_5", 5 * 37.3e6, "navfn");
  bench.published("astar_instructions_of_5", 5 * 26.7e6, "navfn");

  double optimum = 0.0;
  bench.metric("optimum_length", [&] {
    for (const Query& q : queries) optimum += octile_optimum(costs, q);
    return optimum;
  });
  const auto ratio = [&](const char* key, Workload& workload, double at_most) {
    bench.metric(key, [&] {
      workload.run();
      return workload.length() / optimum;
    });
    bench.target(key, Bound::kAtMost, at_most);
  };
  ratio("length_ratio", dijkstra, 1.03);
  ratio("length_ratio_astar", astar, 1.03);
  ratio("length_ratio_uniform", dijkstra_uniform, 1.0005);
  ratio("length_ratio_astar_uniform", astar_uniform, 1.0005);
  bench.published("length_ratio", 0.996, "navfn");
  bench.metric("failed_queries", [&] {
    return static_cast<double>(dijkstra.failed() + astar.failed() + dijkstra_uniform.failed() +
                               astar_uniform.failed());
  });
  bench.target("failed_queries", Bound::kAtMost, 0);
  return bench.run(argc, argv);
}
