#include "navigation/roadmap/core/roadmap_planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "foundation/result/bounds.hpp"
#include "navigation/roadmap/core/path_smoother.hpp"

namespace usher::roadmap {

namespace {

constexpr std::int8_t kOccupiedFrom = 65;  // percent, as map_server's default

Status check(const RoadmapConfig& c) {
  return within({
      {"inflation", c.inflation, 0.01, 2.0},
      {"cell_size", c.sampling.cell_size, 0.1, 50.0},
      {"points_per_cell", static_cast<double>(c.sampling.points_per_cell), 1, 1000},
      {"grid_step", c.sampling.grid_step, 0.1, 50.0},
      {"random_points", static_cast<double>(c.sampling.random_points), 1, 100000},
      {"max_connections", static_cast<double>(c.connection.max_connections), 1, 200},
      {"max_attempts", static_cast<double>(c.connection.max_attempts), 1, 1000},
      {"neighborhood_radius", c.connection.neighborhood_radius, 0.0, 50.0},
      {"threshold", c.connection.threshold, 0.1, 50.0},
      {"smoothing_passes", static_cast<double>(c.smoothing_passes), 0, 100},
      {"tightening_passes", static_cast<double>(c.tightening_passes), 0, 20},
      {"regenerations", static_cast<double>(c.regenerations), 0, 20},
      {"escape_radius", c.escape_radius, 0.0, 5.0},
      {"goal_tolerance", c.goal_tolerance, 0.0, 5.0},
  });
}

std::string at(const Point2& point) {
  char text[64];
  std::snprintf(text, sizeof(text), "(%.2f, %.2f)", point.x(), point.y());
  return text;
}

}  // namespace

Result<RoadmapPlanner> RoadmapPlanner::create(const RoadmapConfig& config, std::uint64_t seed) {
  if (auto ok = check(config); !ok) return Error{ok.error()};
  return RoadmapPlanner(config, seed);
}

Status RoadmapPlanner::set_map(const grid::OccupancyGrid& map) {
  if (map.empty() || !(map.resolution() > 0.0)) return Error{"the map is empty"};
  map_ = map;
  for (auto& value : map_) value = value >= kOccupiedFrom ? grid::kOccupied : value;
  obstacles_.clear();
  clear_space_.build(map_, config_.inflation);
  generate();
  if (graph_.size() == 0) {
    map_ = {};
    return Error{"nothing is free in the map when its obstacles are grown"};
  }
  return {};
}

void RoadmapPlanner::generate() {
  std::vector<Point2> points;
  sample_points(clear_space_, map_, config_.sampling, random_, points);
  graph_.reset(points);
  graph_.connect(clear_space_, config_.connection, random_);
  if (config_.search == Search::kAstar) search_.prepare(graph_);
  close_obstacles();
}

bool RoadmapPlanner::set_obstacles(std::span<const Point2> points) {
  if (map_.empty()) return false;
  std::vector<std::size_t> cells;
  for (const Point2& point : points) {
    if (!point.allFinite() || !(point.cwiseAbs().maxCoeff() < 1e6)) continue;
    const grid::Cell cell = map_.geometry().cell_at(point);
    if (map_.geometry().contains(cell) && map_.at(cell) != grid::kOccupied)
      cells.push_back(map_.geometry().index(cell));
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  if (cells == obstacles_) return false;
  obstacles_ = std::move(cells);
  graph_.restore();
  close_obstacles();
  return true;
}

void RoadmapPlanner::close_obstacles() {
  if (obstacles_.empty()) return;
  grid::OccupancyGrid now = map_;
  const grid::GridGeometry& g = map_.geometry();
  Box box{g.center(g.cell(obstacles_.front())), g.center(g.cell(obstacles_.front()))};
  for (const std::size_t index : obstacles_) {
    now[index] = grid::kOccupied;
    const Point2 center = g.center(g.cell(index));
    box = {box.low.cwiseMin(center), box.high.cwiseMax(center)};
  }
  space_.build(now, config_.inflation);
  const Point2 margin = Point2::Constant(config_.inflation + 2.0 * g.resolution);
  graph_.update(space_, {box.low - margin, box.high + margin}, config_.connection, random_);
}

void RoadmapPlanner::visible(const Point2& point, std::vector<Graph::Candidate>& seen) {
  const auto count = static_cast<std::size_t>(config_.connection.max_attempts);
  graph_.nearest(point, count, graph_.usual_radius(count), seen);
  std::size_t kept = 0;
  for (const auto candidate : seen) {
    if (kept >= static_cast<std::size_t>(config_.connection.max_connections)) break;
    if (space().line_free(point, graph_.vertex(candidate.vertex))) seen[kept++] = candidate;
  }
  seen.resize(kept);
}

bool RoadmapPlanner::search(const Point2& start, const Point2& goal) {
  route_.way_points.assign(1, start);
  if (!space().line_free(start, goal)) {
    visible(start, from_);
    visible(goal, to_);
    const auto way =
        search_.run({graph_, start, goal, from_, to_, config_.search == Search::kAstar});
    if (!way) return false;
    for (const std::uint32_t v : *way) route_.way_points.push_back(graph_.vertex(v));
  }
  route_.way_points.push_back(goal);
  smooth(space(), config_.smoothing_passes, route_.way_points);
  tighten(space(), config_.tightening_passes, route_.way_points);
  return true;
}

const Route& RoadmapPlanner::fail(std::string reason) {
  route_.found = false;
  route_.reason = std::move(reason);
  route_.way_points.clear();
  return route_;
}

const Route& RoadmapPlanner::plan(const Point2& start, const Point2& goal) {
  route_.length = route_.goal_shift = 0.0;
  route_.regenerations = 0;
  if (map_.empty()) return fail("no map");
  for (const Point2* point : {&start, &goal}) {
    const char* what = point == &start ? "start" : "goal";
    if (!point->allFinite() || !(point->cwiseAbs().maxCoeff() < 1e6))
      return fail(std::string(what) + " is not finite");
    if (!map_.geometry().contains(map_.geometry().cell_at(*point)))
      return fail(std::string(what) + " " + at(*point) + " lies outside the map");
  }
  const auto begin = space().nearest_free(start, config_.escape_radius);
  if (!begin) return fail("start " + at(start) + " is blocked and nothing free is near");
  const auto end = space().nearest_free(goal, config_.goal_tolerance);
  if (!end) return fail("goal " + at(goal) + " is blocked and nothing free is near");

  while (!search(*begin, *end)) {
    if (route_.regenerations == config_.regenerations)
      return fail("no path from " + at(start) + " to " + at(goal) + " after " +
                  std::to_string(config_.regenerations) + " new roadmaps");
    ++route_.regenerations;
    generate();
  }
  if (*begin != start) route_.way_points.insert(route_.way_points.begin(), start);
  route_.found = true;
  route_.reason.clear();
  route_.length = length(route_.way_points);
  route_.goal_shift = (*end - goal).norm();
  return route_;
}

std::vector<geometry::Pose2> to_poses(const std::vector<Point2>& way_points, double spacing,
                                      double goal_yaw) {
  std::vector<geometry::Pose2> poses;
  for (std::size_t i = 1; i < way_points.size(); ++i) {
    const Point2 way = way_points[i] - way_points[i - 1];
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / spacing)));
    const double yaw = std::atan2(way.y(), way.x());
    for (int piece = 0; piece < pieces; ++piece) {
      const Point2 point = way_points[i - 1] + way * (static_cast<double>(piece) / pieces);
      poses.push_back({point.x(), point.y(), yaw});
    }
  }
  if (!way_points.empty())
    poses.push_back({way_points.back().x(), way_points.back().y(), goal_yaw});
  return poses;
}

}  // namespace usher::roadmap
