#include "navigation/roadmap/shell/component.hpp"

#include <algorithm>

#include "wire/conversions.hpp"

namespace usher::roadmap {

namespace {
using runtime::HealthState;
constexpr auto kCostsAge = std::chrono::seconds(3);
constexpr std::int8_t kOccupiedFrom = 65;
}  // namespace

RoadmapConfig RoadmapComponent::read_parameters(runtime::Parameters& p) {
  RoadmapConfig c;
  const auto choose = [&](const char* name, const std::vector<std::string>& names,
                          std::size_t value, const char* text) {
    const std::string chosen = p.choice(name, names, names[value], text);
    return static_cast<std::uint8_t>(std::find(names.begin(), names.end(), chosen) - names.begin());
  };
  const auto number = [&](const char* name, const char* unit, double low, double high,
                          double& value, const char* text) {
    value = p.number(name, unit, {low, high}, value, text);
  };
  const auto integer = [&](const char* name, double low, double high, int& value,
                           const char* text) {
    value = static_cast<int>(p.integer(name, "-", {low, high}, value, text));
  };
  auto& s = c.sampling;
  s.sampling = static_cast<Sampling>(choose("sampling", {"random", "grid", "cell", "medial_axis"},
                                            static_cast<std::size_t>(s.sampling),
                                            "Where vertices are put."));
  number("cell_size", "m", 0.1, 50, s.cell_size, "Side of a square of cell and medial_axis.");
  integer("points_per_cell", 1, 1000, s.points_per_cell, "Vertices in each of them.");
  number("grid_step", "m", 0.1, 50, s.grid_step, "Between vertices of the grid.");
  integer("random_points", 1, 100000, s.random_points, "Vertices of random.");
  auto& n = c.connection;
  n.connection = static_cast<Connection>(
      choose("connection", {"nearest", "threshold", "neighborhood"},
             static_cast<std::size_t>(n.connection), "Which vertices are joined."));
  integer("max_connections", 1, 200, n.max_connections, "A vertex looks for no more.");
  integer("max_attempts", 1, 1000, n.max_attempts, "Vertices that are tried for each.");
  number("neighborhood_radius", "m", 0, 50, n.neighborhood_radius, "Of neighborhood.");
  number("threshold", "m", 0.1, 50, n.threshold, "Distance of threshold.");
  number("inflation", "m", 0.01, 2, c.inflation,
         "Obstacles are grown by this: slightly more than half of the robot's longest dimension.");
  c.search = static_cast<Search>(choose("search", {"dijkstra", "astar"},
                                        static_cast<std::size_t>(c.search),
                                        "How the roadmap is searched."));
  integer("smoothing_passes", 0, 100, c.smoothing_passes, "Leave out way points between others.");
  integer("tightening_passes", 0, 20, c.tightening_passes, "Pull the path tight; 0 = do not.");
  integer("regenerations", 0, 20, c.regenerations, "New roadmaps before there is no path.");
  number("escape_radius", "m", 0, 5, c.escape_radius, "How far to look for a free start.");
  number("goal_tolerance", "m", 0, 5, c.goal_tolerance,
         "How far from a blocked goal the path may end.");
  return c;
}

RoadmapComponent::RoadmapComponent(runtime::Host& host)
    : host_(host),
      forget_distance_(host.parameters().number(
          "forget_distance", "m", {0.5, 50}, 4.0,
          "Obstacles that the map does not have are forgotten farther away.")),
      obstacle_tolerance_(host.parameters().number(
          "obstacle_tolerance", "m", {0, 1}, 0.15,
          "What is seen this near to something in the map is taken for it.")),
      rejected_(host.health().counter("inputs: rejected")),
      regenerations_(host.health().counter("roadmaps: regenerated")) {
  auto planner =
      RoadmapPlanner::create(read_parameters(host.parameters()), host.random("roadmap").next());
  if (!planner) host.fault(planner.error());
  planner_.emplace(std::move(planner).value());

  map_ =
      host.input(topics::kMap, {}, [this](const auto& message, const auto&) { take_map(message); });
  map_costs_ = host.input(
      topics::kGlobalCosts, {.max_age = kCostsAge, .on_loss = "answers requests with a failure"},
      [this](const auto& message, const auto&) { take_costs(message); },
      [this] { host_.health().set(HealthState::kDegraded, "no global costs"); });
  outcome_ = host.input(topics::kNavigateStatus, {.optional = true},
                        [this](const auto& status, const auto&) { take_outcome(status); });
  server_.emplace(host, [this](const auto& start, const auto& goal) { return plan(start, goal); });
}

void RoadmapComponent::take_map(const nav_msgs::msg::OccupancyGrid& message) {
  const auto map = wire::from_message(message);
  Status taken = map ? planner_->set_map(*map) : Status(Error{map.error()});
  if (!taken) {
    ++rejected_;
    map_refused_ = "map refused: " + taken.error();
    host_.health().set(HealthState::kDegraded, map_refused_);
    return;
  }
  map_refused_.clear();
  resolution_ = map->resolution();
  map_distances_.build(*map, obstacle_tolerance_ + 2.0 * resolution_, kOccupiedFrom);
  obstacles_.clear();
}

void RoadmapComponent::take_costs(const usher_msgs::msg::Costmap& message) {
  auto costs = wire::from_message(message);
  if (!costs) {
    ++rejected_;
    host_.health().set(HealthState::kDegraded, "global costs refused: " + costs.error());
    return;
  }
  costs_ = std::move(costs).value();
  const std::string lacks = !map_refused_.empty() ? map_refused_
                            : planner_->has_map() ? ""
                                                  : "no map";
  host_.health().set(lacks.empty() ? HealthState::kOk : HealthState::kDegraded, lacks);
}

/// At its goal the robot forgets what stood in its way.
void RoadmapComponent::take_outcome(const usher_msgs::msg::NavigateStatus& status) {
  if (status.state() != usher_msgs::msg::GoalStatus_Constants::STATE_SUCCEEDED) return;
  obstacles_.clear();
  planner_->set_obstacles({});
}

/// Only what is near the robot: farther things are forgotten, the rest of the costs is not asked.
void RoadmapComponent::look_for_obstacles(const Point2& robot) {
  new_obstacles(*costs_, map_distances_, robot, forget_distance_, obstacle_tolerance_, obstacles_);
  planner_->set_obstacles(obstacles_);
}

Result<wire::PlannedPath> RoadmapComponent::plan(const geometry::Pose2& start,
                                                 const geometry::Pose2& goal) {
  if (!planner_->has_map()) return Error{"no map"};
  if (!map_costs_.fresh() || !costs_) return Error{"no global costs"};
  look_for_obstacles(start.position());
  const Route& route = planner_->plan(start.position(), goal.position());
  regenerations_ += static_cast<std::uint64_t>(route.regenerations);
  if (!route.found) return Error{route.reason};
  return wire::PlannedPath{to_poses(route.way_points, resolution_, goal.yaw), route.length};
}

}  // namespace usher::roadmap
