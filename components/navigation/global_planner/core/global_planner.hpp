#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/costs.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::global_planner {

/// Costs of a map's cells (foundation/grid/costs.hpp).
using CostGrid = grid::Grid<std::uint8_t>;

/// Why there is no plan.
enum class PlanFailure : std::uint8_t {
  kNone,          ///< there is one
  kBadInput,      ///< a pose that is not finite, an empty or oversized map
  kStartOutside,  ///< the start lies outside the map
  kGoalOutside,   ///< the goal lies outside the map
  kStartBlocked,  ///< the start is in an obstacle and no free cell is within the escape radius
  kGoalBlocked,   ///< no free cell is within the goal tolerance
  kDisconnected,  ///< start and goal are free, but no path joins them
  kTooLong,       ///< the path costs more than the planner can count
};

/// The name of a failure for logs and status texts, for example "goal blocked".
const char* name(PlanFailure failure);

/// A path with what is worth knowing about it, or the reason why there is none.
struct Plan {
  PlanFailure failure = PlanFailure::kNone;
  std::string reason;  ///< a sentence with positions; empty when there is a path

  /// In the frame of the map, from the start to the goal, neighbours about one cell apart. Yaw
  /// points along the path, at the last pose it is the goal's. Empty on failure.
  std::vector<geometry::Pose2> path;
  double length = 0.0;  ///< [m] along the path
  double escape_distance =
      0.0;  ///< [m] first part of the path, out of cells that are blocked; 0 = none
  double goal_shift =
      0.0;  ///< [m] from the wanted goal to the path's end; more than 0 = it was blocked
  std::uint32_t cells_expanded = 0;

  bool ok() const { return failure == PlanFailure::kNone; }
};

/// Finds a path through a map. Grid planner and roadmap planner are implementations.
class GlobalPlanner {
 public:
  virtual ~GlobalPlanner() = default;

  /// Poses are in the frame of the map (its origin counts). The plan belongs to the planner and
  /// lives until the next call. Every input gets an answer: bad input is a failure, not an error.
  virtual const Plan& plan(const CostGrid& costs, const geometry::Pose2& start_in_map,
                           const geometry::Pose2& goal_in_map) = 0;
};

}  // namespace usher::global_planner
