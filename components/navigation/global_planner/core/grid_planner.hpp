#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/result/result.hpp"
#include "navigation/global_planner/core/global_planner.hpp"
#include "navigation/global_planner/core/grid_search.hpp"
#include "navigation/global_planner/core/path_refiner.hpp"

namespace usher::global_planner {

enum class Algorithm : std::uint8_t {
  kDijkstra,  ///< the thesis' choice (5.3.1)
  kAstar,  ///< the same cost of the path in a third of the time; among equally cheap paths it may
           ///< pick another
};

enum class Metric : std::uint8_t {
  kInflated,  ///< a step costs its length times (neutral_cost + cost_factor * cost of the cell it
              ///< enters)
  kShortest,  ///< a step costs its length
};

struct GridPlannerConfig {
  Algorithm algorithm = Algorithm::kDijkstra;
  Metric metric = Metric::kInflated;
  double neutral_cost =
      50.0;  ///< cost of a metre of free floor, relative to cost_factor; [1, 1000]
  double cost_factor =
      0.8;  ///< [0, 60 * neutral_cost / 252]; navfn's default ratio, 50..252 over the costs
  bool allow_unknown = false;  ///< plan through cells that were never seen
  int unknown_cost = 0;        ///< what such a cell costs; [0, 252]
  double escape_radius =
      0.4;  ///< [m] how far to look for a free cell when the start is blocked; [0, 5]
  double goal_tolerance =
      0.3;  ///< [m] how far from the goal the path may end when the goal is blocked; [0, 5]
  bool refine = true;  ///< pull tight and round; otherwise the path runs over cell centres
  int smoothing_iterations = 10;  ///< [0, 1000]
};

/// Plans on the cells of a costmap. A query costs one copy of the map and the search; it allocates
/// only when it needs more than any before it.
///
/// Start in a blocked cell: the path first leads straight to the nearest free cell within the
/// escape radius whose way crosses no lethal cell (the start's own excepted), and is not smoothed
/// up to there. Goal in a blocked or cut-off cell: the path ends in the nearest cell within the
/// goal tolerance that can be reached. Both are reported in the plan.
class GridPlanner final : public GlobalPlanner {
 public:
  /// The error names the field, its range and what was found.
  static Result<GridPlanner> create(const GridPlannerConfig& config);

  /// Limits: maps of at most 65,000 x 65,000 cells. Complexity: O(cells nearer than the goal).
  const Plan& plan(const CostGrid& costs, const geometry::Pose2& start_in_map,
                   const geometry::Pose2& goal_in_map) override;

 private:
  explicit GridPlanner(const GridPlannerConfig& config);

  PlanFailure search(const CostGrid& costs, const geometry::Pose2& start,
                     const geometry::Pose2& goal);
  const Plan& fail(PlanFailure failure, const CostGrid& costs, const geometry::Pose2& start,
                   const geometry::Pose2& goal);
  void order_offsets(double resolution);
  std::optional<grid::Cell> escape_cell(const geometry::Point2& start_in_cells) const;
  /// The nearest cell to `center` within the goal tolerance that `accept` takes.
  template <class Accept>
  std::optional<grid::Cell> nearest(grid::Cell center, double radius, Accept&& accept) const;
  void write_plan(const CostGrid& costs, const geometry::Pose2& start, const geometry::Pose2& goal);

  GridPlannerConfig config_;
  CostField field_;
  GridSearch search_;
  PathRefiner refiner_;
  Plan plan_;
  std::vector<grid::Cell> offsets_;  // within the larger radius, nearest first
  double offsets_resolution_ = 0.0;
  grid::Cell begin_;  // where the search starts and ends, after escape and shift
  grid::Cell end_;
  bool escaped_ = false;
  bool shifted_ = false;
  std::vector<grid::Cell> cells_;
  std::vector<geometry::Point2> points_;  // [cells]
};

}  // namespace usher::global_planner
