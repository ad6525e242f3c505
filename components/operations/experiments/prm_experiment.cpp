#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "foundation/grid/map_file.hpp"
#include "navigation/roadmap/core/roadmap_planner.hpp"
#include "operations/command_line/table.hpp"
#include "operations/experiments/experiment.hpp"
#include "operations/experiments/run_record.hpp"

namespace usher::operations {

namespace {

using namespace roadmap;

constexpr int kTrials = 3;
constexpr std::array<int, 4> kConnections = {5, 10, 20, 30};

/// Long, medium, short, and into the narrow corridor: the four qualitatively different pairs of the
/// report (its figure 7), in the arena.
struct Pair {
  const char* name;
  Point2 start, goal;
};
const std::array<Pair, 4> kPairs = {{{"long", {1.5, 1.5}, {15.0, 9.0}},
                                     {"medium", {3.2, 9.6}, {10.0, 2.0}},
                                     {"short", {1.5, 1.5}, {4.5, 1.5}},
                                     {"corridor", {9.5, 7.5}, {15.6, 11.05}}}};

struct Variant {
  SamplingParameters sampling;
  std::string text;
};

std::vector<Variant> variants(Sampling sampling) {
  std::vector<Variant> all;
  if (sampling == Sampling::kRandom) {
    for (const int points : {25, 50, 100, 200, 400, 800})
      all.push_back(
          {{.sampling = sampling, .random_points = points}, std::to_string(points) + " points"});
  } else if (sampling == Sampling::kGrid) {
    for (const double step : {0.5, 1.0, 2.0, 4.0})
      all.push_back({{.sampling = sampling, .grid_step = step}, format("step %.1f m", step)});
  } else {
    for (const double size : {1.0, 2.0, 4.0, 6.0}) {
      for (const int points : {2, 5})
        all.push_back({{.sampling = sampling, .cell_size = size, .points_per_cell = points},
                       format("cells of %.0f m, ", size) + std::to_string(points) + " points"});
    }
  }
  return all;
}

struct Score {
  double tight = 0.0;   ///< mean of length / optimum over what was solved, pulled tight
  double report = 0.0;  ///< the same with algorithm 4 alone
  int solved = 0, asked = 0;
  bool complete() const { return solved == asked; }
};

double plan_length(RoadmapPlanner& planner, const Pair& pair) {
  const Route& route = planner.plan(pair.start, pair.goal);
  return route.found && route.goal_shift == 0.0 ? route.length : -1.0;
}

Result<Score> score(const grid::OccupancyGrid& map, const RoadmapConfig& config,
                    const std::array<double, 4>& optimum) {
  Score score;
  RoadmapConfig plain = config;
  plain.tightening_passes = 0;
  double tight = 0.0, report = 0.0;
  for (int trial = 1; trial <= kTrials; ++trial) {
    auto one = RoadmapPlanner::create(config, static_cast<std::uint64_t>(trial));
    auto other = RoadmapPlanner::create(plain, static_cast<std::uint64_t>(trial));
    if (!one || !other) return Error{one ? other.error() : one.error()};
    Status set = one->set_map(map);
    if (set) set = other->set_map(map);
    for (std::size_t i = 0; i < kPairs.size(); ++i) {
      ++score.asked;
      const double length = set ? plan_length(*one, kPairs[i]) : -1.0;
      const double plain_length = set ? plan_length(*other, kPairs[i]) : -1.0;
      if (length < 0.0 || plain_length < 0.0) continue;
      ++score.solved;
      tight += length / optimum[i];
      report += plain_length / optimum[i];
    }
  }
  score.tight = score.solved > 0 ? tight / score.solved : std::numeric_limits<double>::quiet_NaN();
  score.report =
      score.solved > 0 ? report / score.solved : std::numeric_limits<double>::quiet_NaN();
  return score;
}

/// The shortest paths that many dense roadmaps find, pulled tight: within a few millimetres of the
/// shortest there are.
Result<std::array<double, 4>> find_optimum(const grid::OccupancyGrid& map,
                                           std::vector<DrawnWay>& ways) {
  constexpr int kDense = 5;
  std::array<double, 4> best;
  best.fill(std::numeric_limits<double>::infinity());
  ways.assign(kPairs.size(), {});
  RoadmapConfig config;
  config.sampling.cell_size = 0.4;
  config.sampling.points_per_cell = 4;
  config.connection.connection = Connection::kNearest;
  config.connection.max_attempts = config.connection.max_connections = 60;
  config.tightening_passes = 12;
  for (int seed = 1; seed <= kDense; ++seed) {
    auto planner = RoadmapPlanner::create(config, static_cast<std::uint64_t>(seed));
    if (!planner) return Error{planner.error()};
    if (auto set = planner->set_map(map); !set) return Error{set.error()};
    for (std::size_t i = 0; i < kPairs.size(); ++i) {
      const Route& route = planner->plan(kPairs[i].start, kPairs[i].goal);
      if (!route.found) return Error{std::string(kPairs[i].name) + ": " + route.reason};
      if (route.length >= best[i]) continue;
      best[i] = route.length;
      ways[i] = {std::string(kPairs[i].name) + format(" %.2f m", route.length),
                 static_cast<int>(60 * i),
                 110,
                 200 - static_cast<int>(50 * i),
                 2,
                 route.way_points};
    }
  }
  return best;
}

struct Named {
  const char* name;
  double published[3];  ///< figure 8: nearest, threshold, neighborhood; 0 = not in it
};
constexpr std::array<Named, 4> kSamplings = {{{"random", {1.05171, 1.06639, 1.02578}},
                                              {"grid", {1.14463, 1.05153, 1.03693}},
                                              {"cell", {1.09907, 1.12969, 1.03909}},
                                              {"medial_axis", {0.0, 0.0, 0.0}}}};
constexpr std::array<const char*, 3> kConnectionNames = {"nearest", "threshold", "neighborhood"};

}  // namespace

Result<ResultSheet> run_prm_experiment(const ExperimentOptions& options) {
  const auto map = grid::load_map(options.installation.share + "/config/sites/arena/map.yaml");
  if (!map) return Error{map.error()};
  std::vector<DrawnWay> ways;
  const auto optimum = find_optimum(*map, ways);
  if (!optimum) return Error{optimum.error()};

  ResultSheet sheet;
  sheet.name = "prm";
  sheet.input = "the arena, four pairs of points, " + std::to_string(kTrials) + " trials each";
  Table best(
      {"sampling", "connection", "best score", "algorithm 4 alone", "fig. 8", "solved", "with"});
  std::string csv = "sampling,connection,max_connections,variant,score,algorithm_4,solved,asked\n";
  for (std::size_t s = 0; s < kSamplings.size(); ++s) {
    for (std::size_t c = 0; c < kConnectionNames.size(); ++c) {
      Score winner;
      std::string with;
      int solved = 0, asked = 0;
      for (const Variant& variant : variants(static_cast<Sampling>(s))) {
        show_progress(std::string(kSamplings[s].name) + ", " + kConnectionNames[c] + ", " +
                      variant.text);
        for (const int connections : kConnections) {
          RoadmapConfig config;
          config.sampling = variant.sampling;
          config.connection.connection = static_cast<Connection>(c);
          config.connection.max_connections = connections;
          config.regenerations = 0;
          const auto found = score(*map, config, *optimum);
          if (!found) return Error{found.error()};
          solved += found->solved;
          asked += found->asked;
          csv += std::string(kSamplings[s].name) + "," + kConnectionNames[c] + "," +
                 std::to_string(connections) + "," + variant.text + format(",%.5f", found->tight) +
                 format(",%.5f", found->report) + "," + std::to_string(found->solved) + "," +
                 std::to_string(found->asked) + "\n";
          // Who solves more is better; among equals the shorter paths.
          const bool better = winner.asked == 0 || found->solved > winner.solved ||
                              (found->solved == winner.solved && found->tight < winner.tight);
          if (!better) continue;
          winner = *found;
          with = variant.text + ", " + std::to_string(connections) + " connections";
        }
      }
      const std::string key = std::string(kSamplings[s].name) + "_" + kConnectionNames[c];
      const double published = kSamplings[s].published[c];
      best.add({kSamplings[s].name, kConnectionNames[c], format("%.5f", winner.tight),
                format("%.5f", winner.report), published > 0.0 ? format("%.5f", published) : "",
                std::to_string(winner.solved) + " of " + std::to_string(winner.asked), with});
      sheet.metrics[key + "_score"] = winner.tight;
      sheet.metrics[key + "_score_algorithm_4"] = winner.report;
      sheet.metrics[key + "_success_all_variants"] = static_cast<double>(solved) / asked;
      if (published > 0.0) sheet.published[key + "_score"] = published;
      if (std::string_view(kConnectionNames[c]) != "neighborhood" || s < 2) continue;
      sheet.flags[key + "_solves_every_query"] = winner.complete();
      sheet.targets[key + "_score"] = {Bound::kAtMost, 1.02};
    }
  }
  show_progress("");
  std::printf("%s\n", best.text().c_str());
  Status saved = write_file(options.out + "/combinations.md", best.markdown());
  if (saved) saved = write_file(options.out + "/combinations.csv", csv);
  if (saved)
    saved =
        draw_ways(ways, *map, "the shortest paths of the four pairs", options.out + "/optimum.png");
  if (!saved) return Error{saved.error()};
  return sheet;
}

}  // namespace usher::operations
