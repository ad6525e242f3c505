// The dynamic window's cycle on the input that its peers were measured on: the Willow Garage map, a
// 4 x 4 m window with static walls, one scan and inflation, a plan straight on, 63 trajectories of
// 20 points. Then many trajectories where neither circle decides.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/local_planner/core/dynamic_window.hpp"
#include "support/bench.hpp"

namespace usher::local_planner {
namespace {

using geometry::Point2;
using geometry::Pose2;
using Costs = grid::Grid<std::uint8_t>;

constexpr double kResolution = 0.05;
constexpr double kInflation = 0.55;

Footprint sixteen_gon() {
  std::vector<Point2> corners;
  for (int i = 0; i < 16; ++i) {
    corners.emplace_back(0.3 * std::cos(geometry::kPi * i / 8),
                         0.3 * std::sin(geometry::kPi * i / 8));
  }
  return Footprint::make(corners).value();
}

/// A binary PGM with row 0 at the top, as a grid with row 0 at the bottom.
Costs read_pgm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string magic;
  int width = 0;
  int height = 0;
  int most = 0;
  file >> magic >> width >> height >> most;
  file.get();
  if (magic != "P5" || width <= 0 || height <= 0 || most != 255) return {};
  std::vector<char> pixels((std::istreambuf_iterator<char>(file)),
                           std::istreambuf_iterator<char>());
  Costs map({width, height, kResolution, 0.0, 0.0});
  if (pixels.size() < map.size()) return {};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      map.at({x, y}) = static_cast<std::uint8_t>(
          pixels[static_cast<std::size_t>(height - 1 - y) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(x)]);
    }
  }
  return map;
}

/// The end points of the peers' scan: 541 beams over 270 degrees, marched in 12.5 mm, 10 mm noise.
std::vector<Point2> scan(const Costs& map, const Pose2& pose, std::uint64_t seed) {
  Random random(seed);
  std::vector<Point2> points;
  for (int i = 0; i < 541; ++i) {
    const double angle = pose.yaw + geometry::radians(-135.0 + 0.5 * i);
    bool hit = false;
    double t = 0.0;
    for (; t < 30.0 && !hit; t += 0.0125) {
      const grid::Cell cell =
          map.geometry().cell_at(pose.x + t * std::cos(angle), pose.y + t * std::sin(angle));
      if (!map.geometry().contains(cell)) break;
      hit = map.at(cell) <= 89;
    }
    const double noise = 0.01 * random.gaussian();
    if (!hit) continue;
    const double range = std::max(0.05, t - 0.0125 + noise);
    points.emplace_back(pose.x + range * std::cos(angle), pose.y + range * std::sin(angle));
  }
  return points;
}

void inflate(Costs& costs, double inscribed) {
  const grid::GridGeometry& g = costs.geometry();
  std::vector<grid::Cell> lethal;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (costs[i] == usher::grid::kLethalCost) lethal.push_back(g.cell(i));
  }
  const int reach = static_cast<int>(kInflation / kResolution);
  for (const grid::Cell& cell : lethal) {
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const grid::Cell near{cell.x + dx, cell.y + dy};
        const double distance = std::hypot(dx, dy) * kResolution;
        if (!g.contains(near) || distance > kInflation || (dx == 0 && dy == 0)) continue;
        const std::uint8_t cost =
            distance <= inscribed
                ? usher::grid::kInscribedCost
                : static_cast<std::uint8_t>(252.0 * std::exp(-10.0 * (distance - inscribed)));
        if (costs.at(near) != usher::grid::kUnknownCost)
          costs.at(near) = std::max(costs.at(near), cost);
      }
    }
  }
}

/// The peers' rolling costmap: the static map's walls (unknown stays unknown), the scan's end
/// points, inflation.
Costs window(const Costs& map, const Pose2& pose, double side) {
  const int cells = static_cast<int>(std::lround(side / kResolution));
  const grid::Cell center = map.geometry().cell_at(pose.x, pose.y);
  const grid::Cell first{center.x - cells / 2, center.y - cells / 2};
  Costs costs({cells, cells, kResolution, first.x * kResolution, first.y * kResolution});
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const std::uint8_t pixel = map.value_or({first.x + x, first.y + y}, 205);
      costs.at({x, y}) = pixel <= 89    ? usher::grid::kLethalCost
                         : pixel >= 206 ? 0
                                        : usher::grid::kUnknownCost;
    }
  }
  for (const Point2& point : scan(map, pose, 1)) {
    const grid::Cell cell = costs.geometry().cell_at(point);
    if (costs.geometry().contains(cell)) costs.at(cell) = usher::grid::kLethalCost;
  }
  inflate(costs, sixteen_gon().inscribed_radius());
  return costs;
}

/// The peers' limits and sampling: 3 x 21 trajectories, 1.7 s, 20 points.
DynamicWindowConfig peer() {
  DynamicWindowConfig config;
  config.footprint = sixteen_gon();
  config.pace = 0.55;
  config.fastest_turn = 1.0;
  config.limits = {.acceleration = 2.5, .deceleration = 2.5, .angular_acceleration = 3.2};
  config.speed_samples = 3;
  config.turn_samples = 21;
  config.simulated_time = 1.7;
  config.steps = 20;
  return config;
}

struct Cycle {
  Costs costs;
  Pose2 pose;
  DynamicWindow planner;
  geometry::Twist2 velocity{0.3, 0.1};
  Decision last;
  void run() { last = planner.decide(costs, pose, velocity, velocity, 0.05); }
};

Cycle peer_cycle(const Costs& map, const Pose2& pose) {
  std::vector<Pose2> path;
  for (double x = 0.0; x < 4.0; x += 0.05) path.push_back({pose.x + x, pose.y, 0.0});
  DynamicWindow planner = DynamicWindow::make(peer()).value();
  if (!planner.set_path(path).ok()) std::abort();
  return {window(map, pose, 4.0), pose, std::move(planner), {0.3, 0.1}, {}};
}

/// The free cell nearest to (41, 13.6) with 0.45 m to the next wall: the peers' cluttered place.
Pose2 cluttered_place(const Costs& map) {
  const grid::GridGeometry& g = map.geometry();
  Pose2 best;
  double nearest = 1e9;
  for (int y = 240; y < 310; ++y) {
    for (int x = 780; x < 860; ++x) {
      bool clear = true;
      for (int dy = -9; dy <= 9 && clear; ++dy) {
        for (int dx = -9; dx <= 9 && clear; ++dx) {
          clear =
              std::hypot(dx, dy) * kResolution > 0.45 || map.value_or({x + dx, y + dy}, 0) >= 206;
        }
      }
      const Point2 c = g.center({x, y});
      const double distance = std::hypot(c.x() - 41.0, c.y() - 13.6);
      if (clear && distance < nearest) nearest = distance, best = {c.x(), c.y(), 0.0};
    }
  }
  return best;
}

/// A straight passage between rows of posts in which every point of every trajectory lies nearer to
/// a lethal cell than the circumscribed radius and farther than the inscribed one: both circles say
/// nothing, the polygon must decide.
Cycle narrow_cycle() {
  DynamicWindowConfig config;
  config.footprint = Footprint::rectangle(0.72, 0.56);
  config.clearance = 0.0;
  config.careful_speed = 0.0;
  config.pace = 0.55;
  config.limits = {.acceleration = 2.5, .deceleration = 2.5, .angular_acceleration = 0.3};
  config.speed_samples = 32;
  config.turn_samples = 33;
  config.fastest_turn = 0.06;
  config.margin = 0.0;
  const Pose2 pose{2.0, 2.025, 0.0};
  Costs costs({80, 80, kResolution, 0.0, 0.0});
  for (int x = 0; x < 80; x += 2)
    costs.at({x, 40 + 8}) = costs.at({x, 40 - 8}) = usher::grid::kLethalCost;
  inflate(costs, config.footprint.inscribed_radius());
  DynamicWindow planner = DynamicWindow::make(config).value();
  if (!planner.set_path(std::vector<Pose2>{pose, {6.0, 2.025, 0.0}}).ok()) std::abort();
  return {std::move(costs), pose, std::move(planner), {0.3, 0.0}, {}};
}

/// Share of the points of the area that the trajectories cross whose circles do not decide.
double undecided_share(const Cycle& cycle) {
  const grid::GridGeometry& g = cycle.costs.geometry();
  const Footprint& footprint = cycle.planner.config().footprint;
  int undecided = 0;
  int points = 0;
  for (double x = 2.0; x < 3.0; x += 0.01) {
    for (double y = 1.985; y <= 2.065; y += 0.01, ++points) {
      double nearest = 1e9;
      for (std::size_t i = 0; i < cycle.costs.size(); ++i) {
        if (cycle.costs[i] != usher::grid::kLethalCost) continue;
        const Point2 c = g.center(g.cell(i));
        const double dx = std::max(0.0, std::abs(c.x() - x) - 0.5 * kResolution);
        const double dy = std::max(0.0, std::abs(c.y() - y) - 0.5 * kResolution);
        nearest = std::min(nearest, std::hypot(dx, dy));
      }
      undecided +=
          nearest > footprint.inscribed_radius() && nearest < footprint.circumscribed_radius();
    }
  }
  return static_cast<double>(undecided) / points;
}

}  // namespace
}  // namespace usher::local_planner

int main(int argc, char** argv) {
  using usher::bench::Bound;
  namespace nav = usher::local_planner;
  usher::bench::Bench bench(
      "local_planner",
      "willow-trinary, 4x4 m window with one scan and 0.55 m inflation, straight plan, 63 "
      "trajectories of 20 points, 16-gon; then 1056 trajectories of 20 points, 0.72 x 0.56 m "
      "rectangle between posts where only the polygon decides");
  const std::string path = usher::test_data("peers/willow-trinary-0.05.pgm");
  if (path.empty()) {
    std::fprintf(stderr,
                 "bench local_planner: no peers/willow-trinary-0.05.pgm below USHER_TEST_DATA\n");
    return 4;
  }
  const nav::Costs map = nav::read_pgm(path);
  nav::Cycle corridor = nav::peer_cycle(map, {27.5, 17.5, 0.0});
  nav::Cycle cluttered = nav::peer_cycle(map, nav::cluttered_place(map));
  nav::Cycle narrow = nav::narrow_cycle();

  bench.time("cycle_us", 1e-6, [&] { corridor.run(); });
  bench.time("cycle_cluttered_us", 1e-6, [&] { cluttered.run(); });
  bench.time("narrow_cycle_us", 1e-6, [&] { narrow.run(); });
  bench.instructions("cycle_instructions", [&] { corridor.run(); });
  bench.instructions("narrow_cycle_instructions", [&] { narrow.run(); });
  bench.metric("trajectories", [&] { return static_cast<double>(corridor.last.trajectories); });
  bench.metric("admissible", [&] { return static_cast<double>(corridor.last.admissible); });
  bench.metric("admissible_cluttered",
               [&] { return static_cast<double>(cluttered.last.admissible); });
  bench.metric("narrow_trajectories",
               [&] { return static_cast<double>(narrow.last.trajectories); });
  bench.metric("narrow_admissible", [&] { return static_cast<double>(narrow.last.admissible); });
  bench.metric("narrow_undecided_share", [&] { return nav::undecided_share(narrow); });
  bench.metric("trajectories_per_second", [&] {
    return static_cast<double>(narrow.last.trajectories) /
           (1e-6 * bench.metrics().at("narrow_cycle_us"));
  });
  bench.published("cycle_us", 1095, "dwa_local_planner, corridor");
  bench.published("cycle_cluttered_us", 1098, "dwa_local_planner, cluttered");
  bench.published("cycle_instructions", 17153157, "dwa_local_planner, corridor");
  bench.published("trajectories_per_second", 57500, "dwa_local_planner, corridor");
  bench.target("cycle_us", Bound::kAtMost, 120);
  bench.target("trajectories_per_second", Bound::kAtLeast, 1e6);
  return bench.run(argc, argv);
}
