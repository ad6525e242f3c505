#pragma once

#include <vector>

#include "navigation/global_planner/core/cost_field.hpp"

namespace usher::global_planner {

/// Turns a path on the grid into one that a robot likes to follow: straight where the costs allow
/// it, round where it turns. Both steps keep to cells that may be entered, those touched at a
/// corner included.
///
/// 1. Pull tight: from a kept point the farthest later point that a straight line reaches without
/// costing more than
///    the piece of path that it replaces (line integral of the step costs, so it keeps away from
///    walls as the search did).
/// 2. Round: points one cell apart move toward the middle of their neighbours, a fixed number of
/// times; a move that
///    would touch a blocked cell is left out. The displacement is about the square root of the
///    number in cells.
class PathRefiner {
 public:
  explicit PathRefiner(int smoothing_iterations) : smoothing_iterations_(smoothing_iterations) {}

  /// `path` [cells] leads through traversable cells, neighbours at most one cell apart in x and y;
  /// it is replaced by the refined path with the same ends and neighbours at most one cell apart.
  /// Allocates when it is longer than any before.
  void refine(const CostField& field, std::vector<geometry::Point2>& path);

 private:
  void pull_tight(const CostField& field, const std::vector<geometry::Point2>& path);
  void round_corners(const CostField& field, std::vector<geometry::Point2>& path) const;

  int smoothing_iterations_;
  std::vector<double> cost_so_far_;     // along the path, per point
  std::vector<geometry::Point2> kept_;  // what is left of the path when pulled tight
};

/// Appends the segment from `a` (left out) to `b` (included) in equal pieces of at most one cell.
void append_segment(const geometry::Point2& a, const geometry::Point2& b,
                    std::vector<geometry::Point2>& path);

}  // namespace usher::global_planner
