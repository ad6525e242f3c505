// The cost of the simulated world itself: it shares one core with the whole robot in lock-step
// runs.
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#include "simulation/world/core/world.hpp"
#include "support/bench.hpp"

namespace {

using usher::bench::Bench;
using usher::bench::Bound;
using usher::world::World;

std::optional<World> office() {
  const std::string site = std::string(USHER_SOURCE_DIR) + "/config/sites/office/";
  const auto building = usher::world::load_building(site + "world.yaml");
  const auto people = usher::world::load_people(site + "people.yaml");
  if (!building || !people) return std::nullopt;
  return std::optional<World>(std::in_place, usher::world::WorldConfig{}, *building, *people,
                              usher::geometry::Pose2{14.0, 10.0, 0.2}, 1);
}

}  // namespace

int main(int argc, char** argv) {
  auto world = office();
  if (!world) {
    std::fprintf(stderr, "the office is absent\n");
    return 4;
  }
  std::vector<float> ranges;
  const auto step = [&] { world->step(); };
  const auto scan = [&] { world->scan(0, ranges); };
  const auto sonar = [&] { world->sonar(ranges); };
  const auto whiskers = [&] { world->whiskers(); };

  Bench bench("world", "office, eight people, 541-beam scan in corridor A");
  bench.time("step_us", 1e-6, step);
  bench.time("scan_us", 1e-6, scan);
  bench.time("sonar_us", 1e-6, sonar);
  bench.time("whiskers_us", 1e-6, whiskers);
  bench.instructions("step_instructions", step);
  bench.instructions("scan_instructions", scan);
  bench.metric("cpu_percent", [&] {
    const auto& m = bench.metrics();
    // 100 Hz steps, 50 Hz scans and whiskers, 20 Hz sonars; percent of one core.
    return 1e-4 * (100 * m.at("step_us") + 50 * m.at("scan_us") + 50 * m.at("whiskers_us") +
                   20 * m.at("sonar_us"));
  });
  bench.target("scan_us", Bound::kAtMost, 40.0);
  bench.target("scan_instructions", Bound::kAtMost, 300000.0);
  bench.target("step_instructions", Bound::kAtMost, 80000.0);
  bench.target("cpu_percent", Bound::kAtMost, 1.5);
  return bench.run(argc, argv);
}
