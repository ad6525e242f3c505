#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/grid/sampling.hpp"
#include "foundation/random/random.hpp"
#include "foundation/result/result.hpp"
#include "navigation/roadmap/core/graph.hpp"
#include "navigation/roadmap/core/graph_search.hpp"

namespace usher::roadmap {

using grid::Sampling;
using grid::SamplingParameters;

enum class Search : std::uint8_t { kDijkstra, kAstar };

/// The defaults are what the meeting report chose, where it says so.
struct RoadmapConfig {
  SamplingParameters sampling;
  ConnectionParameters connection;
  double inflation = 0.24;  ///< [m] slightly above half of the robot's longest dimension; [0.01, 2]
  Search search = Search::kAstar;  ///< the report: Dijkstra, with the same paths
  int smoothing_passes = 10;       ///< I of algorithm 4; [0, 100]
  int tightening_passes = 3;       ///< beyond it; 0 leaves the way points on vertices; [0, 20]
  int regenerations = 3;           ///< new roadmaps that are tried before there is no path; [0, 20]
  double escape_radius = 0.4;      ///< [m] how far to look for a free start; [0, 5]
  double goal_tolerance = 0.3;     ///< [m] how far from a blocked goal the path may end; [0, 5]
};

/// A path, or why there is none.
struct Route {
  bool found = false;
  std::string reason;              ///< a sentence; empty when there is a path
  std::vector<Point2> way_points;  ///< in map, from the start to the goal
  double length = 0.0;             ///< [m]
  double goal_shift = 0.0;         ///< [m] from the wanted goal to the path's end
  int regenerations = 0;           ///< that this query needed
};

/// The probabilistic roadmap of the meeting report (III-B-2) over one map: vertices sampled in the
/// free space, free lines between them, a search for each query, and new obstacles that close
/// vertices and lines until they go. Same map, seed and calls, same paths.
class RoadmapPlanner {
 public:
  /// The error names the value that is out of its range.
  static Result<RoadmapPlanner> create(const RoadmapConfig& config, std::uint64_t seed);

  /// Takes a map (occupied from 65; unknown is blocked) and builds a roadmap on it; obstacles are
  /// forgotten. Refuses an empty map and one in which nothing is free.
  Status set_map(const grid::OccupancyGrid& map);
  bool has_map() const { return !map_.empty(); }

  /// Replaces the things that stand where the map is free; each is a point that is grown like the
  /// map's obstacles. Vertices and lines that they touch are left out, the cut-off ones joined
  /// anew; what an earlier call closed and this one does not is open again. Points that are not
  /// finite or outside the map are left out. Returns whether anything changed.
  bool set_obstacles(std::span<const Point2> points);

  /// The route belongs to the planner and lives until the next call.
  const Route& plan(const Point2& start, const Point2& goal);

  const Graph& graph() const { return graph_; }
  const FreeSpace& space() const { return obstacles_.empty() ? clear_space_ : space_; }

 private:
  RoadmapPlanner(const RoadmapConfig& config, std::uint64_t seed)
      : config_(config), random_(seed) {}

  void generate();
  void close_obstacles();
  void visible(const Point2& point, std::vector<Graph::Candidate>& seen);
  bool search(const Point2& start, const Point2& goal);
  const Route& fail(std::string reason);

  RoadmapConfig config_;
  Random random_;
  grid::OccupancyGrid map_;
  FreeSpace clear_space_, space_;       // without and with obstacles
  std::vector<std::size_t> obstacles_;  // cells, in order
  Graph graph_;
  GraphSearch search_;
  std::vector<Graph::Candidate> from_, to_;
  Route route_;
};

/// The points of `route` as poses no farther than `spacing` [m] apart, each looking along its way,
/// the last one as `goal_yaw` says.
std::vector<geometry::Pose2> to_poses(const std::vector<Point2>& way_points, double spacing,
                                      double goal_yaw);

}  // namespace usher::roadmap
