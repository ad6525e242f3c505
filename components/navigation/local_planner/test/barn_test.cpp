// The BARN worlds (Perille et al. 2020): dense fields of cylinders, a Jackal, 10 m
// [perille2020barn].
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "navigation/local_planner/test/world.hpp"
#include "support/data.hpp"

namespace usher::local_planner {
namespace {

using namespace testing_world;  // NOLINT: the test's own vocabulary

std::map<int, std::vector<Disc>> read_cylinders(const std::string& path) {
  std::map<int, std::vector<Disc>> worlds;
  gzFile file = gzopen(path.c_str(), "rb");
  char line[256];
  while (file != nullptr && gzgets(file, line, sizeof line) != nullptr) {
    int world = 0;
    Disc disc{};
    if (std::sscanf(line, "%d,%lf,%lf,%lf", &world, &disc.x, &disc.y, &disc.radius) == 4)
      worlds[world].push_back(disc);
  }
  if (file != nullptr) gzclose(file);
  return worlds;
}

/// A Jackal: agile, so its stopping distance is that of the base below, measured: lag and v^2 / 2a.
DynamicWindowConfig jackal() {
  DynamicWindowConfig config;
  config.footprint = Footprint::rectangle(0.508, 0.43);
  const std::vector<kinematics::StoppingPoint> stops{
      {0.5, 0.15}, {1.0, 0.45}, {1.5, 0.9}, {2.0, 1.5}};
  config.stopping = kinematics::StoppingDistance::make(stops).value();
  config.pace = 1.5;
  config.response = {.latency = 0.05,
                     .time_constant = 0.2,
                     .turn_time_constant = 0.15,
                     .acceleration = 2.0,
                     .angular_acceleration = 4.0};
  config.limits = {.acceleration = 1.5, .deceleration = 1.5, .angular_acceleration = 3.0};
  config.fastest_turn = 1.5;
  config.lateral_acceleration = 1.5;
  return config;
}

TEST(Barn, MostWorldsAreCrossed) {
  USHER_REQUIRE_DATA(path, "barn/barn_cylinders.csv.gz");
  const std::map<int, std::vector<Disc>> worlds = read_cylinders(path);
  ASSERT_GE(worlds.size(), 30U);
  const DynamicWindowConfig config = jackal();
  int tried = 0;
  int reached = 0;
  int contacts = 0;
  double seconds = 0.0;
  double metric = 0.0;
  const std::size_t every = worlds.size() / 30;
  std::size_t turn = 0;
  for (const auto& [index, cylinders] : worlds) {
    if (turn++ % every != 0 || tried == 30) continue;
    World world(-6, 1, 2, 15);
    for (const Disc& disc : cylinders) world.add(disc);
    world.finish(config.footprint.inscribed_radius(), 0.5, 5.0);
    const Pose2 start{-2, 3, geometry::kPi / 2};
    const Pose2 goal{-2, 13, geometry::kPi / 2};
    ++tried;
    const auto plan = world.plan(start, goal, 4.0);
    if (!plan) {
      std::printf("  world %d has no path\n", index);
      continue;
    }
    DynamicWindow planner = DynamicWindow::make(config).value();
    ASSERT_TRUE(planner.set_path(*plan).ok());
    Base base{.dead_time = 0.05,
              .lag = 0.2,
              .turn_lag = 0.15,
              .acceleration = 2.0,
              .angular_acceleration = 4.0,
              .pose = start,
              .twist = {}};
    const Drive result = drive(planner, world, base, 100.0, 20.0, 5.0);
    contacts += result.contact;
    if (!result.reached || result.contact) {
      std::printf(
          "  world %d: reached %d, contact %d, %.1f s at (%.2f, %.2f), clearance %.3f: %s\n", index,
          result.reached, result.contact, result.seconds, result.end.x, result.end.y,
          result.clearance, to_string(result.last.reason));
      continue;
    }
    ++reached;
    seconds += result.seconds;
    const double optimal = 10.0 / 2.0;
    metric += optimal / std::clamp(result.seconds, 4.0 * optimal, 8.0 * optimal);
  }
  std::printf(
      "  BARN: %d of %d worlds without contact, %d contacts, mean %.1f s, metric (2022) %.3f\n",
      reached, tried, contacts, reached > 0 ? seconds / reached : 0.0, metric / tried);
  EXPECT_EQ(contacts, 0);
  EXPECT_GE(reached, 26);
}

}  // namespace
}  // namespace usher::local_planner
