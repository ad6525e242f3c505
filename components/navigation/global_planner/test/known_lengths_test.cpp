// Benchmark maps with published optimal lengths [sturtevant2012benchmarks]: shortest paths where a
// diagonal step needs both cells beside it free.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "navigation/global_planner/core/grid_planner.hpp"
#include "support/data.hpp"

namespace usher::global_planner {
namespace {

CostGrid read_map(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string word;
  int height = 0;
  int width = 0;
  file >> word >> word >> word >> height >> word >> width >>
      word;  // type octile height H width W map
  CostGrid costs({.width = width, .height = height, .resolution = 1.0});
  for (auto& cost : costs) {
    char c = 0;
    file >> c;
    cost = c == '.' || c == 'G' || c == 'S' ? 0 : grid::kLethalCost;
  }
  EXPECT_TRUE(file.good()) << path;
  return costs;
}

void check_scenarios(const std::filesystem::path& map, Algorithm algorithm, int& checked) {
  const CostGrid costs = read_map(map);
  GridPlanner planner =
      *GridPlanner::create({.algorithm = algorithm, .metric = Metric::kShortest, .refine = false});
  std::ifstream file(map.string() + ".scen");
  std::string line;
  std::getline(file, line);  // version
  int number = 0;
  int bucket = 0, width = 0, height = 0, sx = 0, sy = 0, gx = 0, gy = 0;
  double optimum = 0.0;
  for (std::string name;
       file >> bucket >> name >> width >> height >> sx >> sy >> gx >> gy >> optimum;) {
    if (number++ % 25 != 0) continue;
    const Plan& plan = planner.plan(costs, {sx + 0.5, sy + 0.5, 0.0}, {gx + 0.5, gy + 0.5, 0.0});
    ASSERT_TRUE(plan.ok()) << map << " scenario " << number << ": " << plan.reason;
    ASSERT_NEAR(plan.length, optimum, std::max(0.006, 1e-5 * optimum))
        << map << " scenario " << number;
    ++checked;
  }
}

class KnownLengths : public testing::TestWithParam<Algorithm> {};

TEST_P(KnownLengths, AreFoundOnEvery25thScenario) {
  USHER_REQUIRE_DATA(folder, "movingai");
  int checked = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".map") continue;
    check_scenarios(entry.path(), GetParam(), checked);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(checked, 1000);
  RecordProperty("scenarios", checked);
}

INSTANTIATE_TEST_SUITE_P(Algorithms, KnownLengths,
                         testing::Values(Algorithm::kDijkstra, Algorithm::kAstar),
                         [](const auto& instance) {
                           return instance.param == Algorithm::kAstar ? "Astar" : "Dijkstra";
                         });

}  // namespace
}  // namespace usher::global_planner
