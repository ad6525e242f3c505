#include "navigation/global_planner/core/path_refiner.hpp"

#include <algorithm>
#include <cmath>

#include "navigation/global_planner/core/line.hpp"

namespace usher::global_planner {
namespace {

using geometry::Point2;

grid::Cell cell_of(const Point2& p) {
  return {static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
}

/// Whether the straight line costs at most `limit` and touches no blocked cell.
bool line_costs_at_most(const CostField& field, const Point2& a, const Point2& b, double limit) {
  double cost = 0.0;
  return visit_line(a, b, [&](grid::Cell c, double length) {
    const std::uint32_t step = field.straight(c);
    cost += step * length;
    return step != StepCosts::kBlocked && cost <= limit;
  });
}

/// Whether all cells of the smallest rectangle around two points may be entered: more than a line
/// needs, but quick for neighbouring cells.
bool rectangle_is_free(const CostField& field, const Point2& a, const Point2& b) {
  const grid::Cell ca = cell_of(a);
  const grid::Cell cb = cell_of(b);
  for (int y = std::min(ca.y, cb.y); y <= std::max(ca.y, cb.y); ++y)
    for (int x = std::min(ca.x, cb.x); x <= std::max(ca.x, cb.x); ++x)
      if (!field.traversable({x, y})) return false;
  return true;
}

}  // namespace

void append_segment(const Point2& a, const Point2& b, std::vector<Point2>& path) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() - 1e-9)));
  for (int i = 1; i < pieces; ++i)
    path.emplace_back(a + (b - a) * (static_cast<double>(i) / pieces));
  path.push_back(b);
}

void PathRefiner::pull_tight(const CostField& field, const std::vector<Point2>& path) {
  cost_so_far_.assign(1, 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double middle =
        0.5 * (field.straight(cell_of(path[i - 1])) + field.straight(cell_of(path[i])));
    cost_so_far_.push_back(cost_so_far_.back() + middle * (path[i] - path[i - 1]).norm());
  }
  kept_.assign(1, path.front());
  for (std::size_t anchor = 0; anchor + 1 < path.size();) {
    const auto pulls_to = [&](std::size_t to) {
      const double limit = (cost_so_far_[to] - cost_so_far_[anchor]) * (1.0 + 1e-6);
      return line_costs_at_most(field, path[anchor], path[to], limit);
    };
    // Doubles the reach while it holds, then halves the gap: few lines, and each no longer than
    // twice the result.
    std::size_t good = anchor + 1;
    std::size_t bad = path.size();
    for (std::size_t reach = 2; good + 1 < bad && anchor + reach < path.size(); reach *= 2) {
      (pulls_to(anchor + reach) ? good : bad) = anchor + reach;
    }
    while (good + 1 < bad) {
      const std::size_t middle = (good + bad) / 2;
      (pulls_to(middle) ? good : bad) = middle;
    }
    kept_.push_back(path[good]);
    anchor = good;
  }
}

void PathRefiner::round_corners(const CostField& field, std::vector<Point2>& path) const {
  constexpr double kStill = 1e-4;  // [cells] a smaller move is not worth its test
  for (int iteration = 0; iteration < smoothing_iterations_; ++iteration) {
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      const Point2 move = 0.25 * (path[i - 1] + path[i + 1]) - 0.5 * path[i];
      if (std::abs(move.x()) < kStill && std::abs(move.y()) < kStill) continue;
      const Point2 moved = path[i] + move;
      if (rectangle_is_free(field, path[i - 1], moved) &&
          rectangle_is_free(field, moved, path[i + 1]))
        path[i] = moved;
    }
  }
}

void PathRefiner::refine(const CostField& field, std::vector<Point2>& path) {
  if (path.size() < 2) return;
  pull_tight(field, path);
  path.clear();
  path.push_back(kept_.front());
  for (std::size_t i = 1; i < kept_.size(); ++i) append_segment(kept_[i - 1], kept_[i], path);
  round_corners(field, path);
}

}  // namespace usher::global_planner
