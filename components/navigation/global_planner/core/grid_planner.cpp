#include "navigation/global_planner/core/grid_planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "foundation/result/bounds.hpp"
#include "navigation/global_planner/core/line.hpp"

namespace usher::global_planner {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr int kMaxSide = 65000;

StepCosts step_costs(const GridPlannerConfig& c) {
  if (c.metric == Metric::kShortest) return StepCosts::shortest(c.allow_unknown);
  return StepCosts::inflated(c.neutral_cost, c.cost_factor, c.allow_unknown, c.unknown_cost);
}

/// A pose's position in cells from the lower left corner of the map.
Point2 in_cells(const CostGrid& costs, const Pose2& pose) {
  const grid::GridGeometry& g = costs.geometry();
  return {(pose.x - g.origin_x) / g.resolution, (pose.y - g.origin_y) / g.resolution};
}

bool inside(const CostGrid& costs, const Point2& p) {
  return p.x() >= 0.0 && p.y() >= 0.0 && p.x() < costs.width() && p.y() < costs.height();
}

grid::Cell cell_of(const Point2& p) {
  return {static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
}
/// A radius of 0.3 m is 6 cells of 0.05 m, whatever the quotient's last bit says.
double radius_in_cells(double radius, double resolution) { return radius / resolution + 1e-6; }
Point2 center(grid::Cell c) { return {c.x + 0.5, c.y + 0.5}; }

bool usable(const CostGrid& costs) {
  const grid::GridGeometry& g = costs.geometry();
  return g.width > 0 && g.height > 0 && g.width <= kMaxSide && g.height <= kMaxSide &&
         costs.size() == g.size() && std::isfinite(g.resolution) && g.resolution > 0.0 &&
         std::isfinite(g.origin_x) && std::isfinite(g.origin_y);
}

}  // namespace

const char* name(PlanFailure failure) {
  switch (failure) {
    case PlanFailure::kNone:
      return "none";
    case PlanFailure::kBadInput:
      return "bad input";
    case PlanFailure::kStartOutside:
      return "start outside the map";
    case PlanFailure::kGoalOutside:
      return "goal outside the map";
    case PlanFailure::kStartBlocked:
      return "start blocked";
    case PlanFailure::kGoalBlocked:
      return "goal blocked";
    case PlanFailure::kDisconnected:
      return "disconnected";
    case PlanFailure::kTooLong:
      return "too long";
  }
  return "unknown";
}

Result<GridPlanner> GridPlanner::create(const GridPlannerConfig& c) {
  if (const Status status = within(
          {{"neutral_cost", c.neutral_cost, 1.0, 1000.0},
           {"cost_factor", c.cost_factor, 0.0, 60.0 * c.neutral_cost / (grid::kInscribedCost - 1)},
           {"unknown_cost", static_cast<double>(c.unknown_cost), 0, grid::kInscribedCost - 1},
           {"escape_radius", c.escape_radius, 0.0, 5.0},
           {"goal_tolerance", c.goal_tolerance, 0.0, 5.0},
           {"smoothing_iterations", static_cast<double>(c.smoothing_iterations), 0, 1000}});
      !status)
    return Error{status.error()};
  return GridPlanner(c);
}

GridPlanner::GridPlanner(const GridPlannerConfig& config)
    : config_(config), field_(step_costs(config)), refiner_(config.smoothing_iterations) {}

void GridPlanner::order_offsets(double resolution) {
  if (resolution == offsets_resolution_) return;
  offsets_resolution_ = resolution;
  offsets_.clear();
  // On a very fine map the radius is bounded in cells, which bounds the work.
  const int reach = static_cast<int>(std::min(
      200.0, radius_in_cells(std::max(config_.escape_radius, config_.goal_tolerance), resolution)));
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x)
      if (x * x + y * y <= reach * reach) offsets_.push_back({x, y});
  std::ranges::stable_sort(offsets_, {}, [](grid::Cell c) { return c.x * c.x + c.y * c.y; });
}

template <class Accept>
std::optional<grid::Cell> GridPlanner::nearest(grid::Cell center, double radius,
                                               Accept&& accept) const {
  const double reach = radius_in_cells(radius, offsets_resolution_);
  for (const grid::Cell& offset : offsets_) {
    if (offset.x * offset.x + offset.y * offset.y > reach * reach) break;
    const grid::Cell c{center.x + offset.x, center.y + offset.y};
    if (field_.contains(c) && accept(c)) return c;
  }
  return std::nullopt;
}

std::optional<grid::Cell> GridPlanner::escape_cell(const Point2& start_in_cells) const {
  const grid::Cell start = cell_of(start_in_cells);
  return nearest(start, config_.escape_radius, [&](grid::Cell c) {
    return field_.traversable(c) &&
           visit_line(start_in_cells, center(c), [&](grid::Cell on_line, double) {
             return on_line == start || field_.cost(on_line) != grid::kLethalCost;
           });
  });
}

PlanFailure GridPlanner::search(const CostGrid& costs, const Pose2& start, const Pose2& goal) {
  if (!start.finite() || !goal.finite() || !usable(costs)) return PlanFailure::kBadInput;
  const Point2 from = in_cells(costs, start);
  const Point2 to = in_cells(costs, goal);
  if (!inside(costs, from)) return PlanFailure::kStartOutside;
  if (!inside(costs, to)) return PlanFailure::kGoalOutside;
  field_.load(costs);
  order_offsets(costs.resolution());

  begin_ = cell_of(from);
  escaped_ = !field_.traversable(begin_);
  if (escaped_) {
    const auto escape = escape_cell(from);
    if (!escape) return PlanFailure::kStartBlocked;
    begin_ = *escape;
  }
  const grid::Cell wanted = cell_of(to);
  const auto free =
      nearest(wanted, config_.goal_tolerance, [&](grid::Cell c) { return field_.traversable(c); });
  if (!free) return PlanFailure::kGoalBlocked;
  end_ = *free;

  const SearchOutcome outcome =
      search_.run(field_, begin_, end_, config_.algorithm == Algorithm::kAstar);
  plan_.cells_expanded = search_.expanded();
  if (outcome == SearchOutcome::kTooLong) return PlanFailure::kTooLong;
  if (outcome == SearchOutcome::kDisconnected) {
    const auto reachable = nearest(wanted, config_.goal_tolerance,
                                   [&](grid::Cell c) { return search_.reached(field_, c); });
    if (!reachable) return PlanFailure::kDisconnected;
    end_ = *reachable;
  }
  shifted_ = !(end_ == wanted);
  search_.trace(field_, end_, cells_);
  return PlanFailure::kNone;
}

const Plan& GridPlanner::plan(const CostGrid& costs, const Pose2& start, const Pose2& goal) {
  plan_.reason.clear();
  plan_.path.clear();
  plan_.length = plan_.escape_distance = plan_.goal_shift = 0.0;
  plan_.cells_expanded = 0;
  plan_.failure = search(costs, start, goal);
  if (!plan_.ok()) return fail(plan_.failure, costs, start, goal);
  write_plan(costs, start, goal);
  return plan_;
}

void GridPlanner::write_plan(const CostGrid& costs, const Pose2& start, const Pose2& goal) {
  const Point2 from = in_cells(costs, start);
  const double resolution = costs.resolution();
  points_.clear();
  for (const grid::Cell& c : cells_) points_.push_back(center(c));
  if (!escaped_) points_.front() = from;
  if (!shifted_) {
    // Start and goal may share their cell.
    if (points_.size() == 1) points_.push_back(points_.front());
    points_.back() = in_cells(costs, goal);
  }
  if (config_.refine) refiner_.refine(field_, points_);

  const auto add = [&](const Point2& p) {
    const Pose2 pose{costs.geometry().origin_x + p.x() * resolution,
                     costs.geometry().origin_y + p.y() * resolution, goal.yaw};
    if (!plan_.path.empty()) {
      Pose2& last = plan_.path.back();
      const double step = geometry::distance(last, pose);
      if (step < 1e-6) return;
      last.yaw = std::atan2(pose.y - last.y, pose.x - last.x);
      plan_.length += step;
    }
    plan_.path.push_back(pose);
  };
  if (escaped_) {
    const Point2 free = points_.front();
    const int pieces = std::max(1, static_cast<int>(std::ceil((free - from).norm())));
    for (int i = 0; i < pieces; ++i) add(from + (free - from) * (static_cast<double>(i) / pieces));
    plan_.escape_distance = (free - from).norm() * resolution;
  }
  for (const Point2& p : points_) add(p);
  plan_.path.back().yaw = geometry::normalized(goal.yaw);
  if (shifted_) plan_.goal_shift = geometry::distance(plan_.path.back(), goal);
}

const Plan& GridPlanner::fail(PlanFailure failure, const CostGrid& costs, const Pose2& start,
                              const Pose2& goal) {
  const grid::GridGeometry& g = costs.geometry();
  char text[256];
  switch (failure) {
    case PlanFailure::kBadInput:
      std::snprintf(text, sizeof text,
                    "expected finite poses and a map of 1 to %d cells a side, got start (%g, %g), "
                    "goal (%g, %g), "
                    "%d x %d cells of %g m",
                    kMaxSide, start.x, start.y, goal.x, goal.y, g.width, g.height, g.resolution);
      break;
    case PlanFailure::kStartOutside:
    case PlanFailure::kGoalOutside: {
      const bool is_start = failure == PlanFailure::kStartOutside;
      const Pose2& pose = is_start ? start : goal;
      std::snprintf(
          text, sizeof text,
          "%s (%.2f, %.2f) m is outside the map, which spans (%.2f, %.2f) to (%.2f, %.2f) m",
          is_start ? "start" : "goal", pose.x, pose.y, g.origin_x, g.origin_y,
          g.origin_x + g.width * g.resolution, g.origin_y + g.height * g.resolution);
      break;
    }
    case PlanFailure::kStartBlocked:
      std::snprintf(
          text, sizeof text,
          "start (%.2f, %.2f) m is blocked (cost %d) and no free cell can be reached within %.2f m",
          start.x, start.y, field_.cost(cell_of(in_cells(costs, start))), config_.escape_radius);
      break;
    case PlanFailure::kGoalBlocked:
      std::snprintf(text, sizeof text,
                    "goal (%.2f, %.2f) m is blocked (cost %d) and no free cell is within %.2f m",
                    goal.x, goal.y, field_.cost(cell_of(in_cells(costs, goal))),
                    config_.goal_tolerance);
      break;
    case PlanFailure::kDisconnected:
      std::snprintf(text, sizeof text, "no path joins start (%.2f, %.2f) m and goal (%.2f, %.2f) m",
                    start.x, start.y, goal.x, goal.y);
      break;
    case PlanFailure::kTooLong:
      std::snprintf(
          text, sizeof text,
          "the path from (%.2f, %.2f) m to (%.2f, %.2f) m costs more than %u steps' worth", start.x,
          start.y, goal.x, goal.y, (StepCosts::kBlocked - 1) / field_.steps().least_straight);
      break;
    case PlanFailure::kNone:
      text[0] = '\0';
      break;
  }
  plan_.reason = text;
  return plan_;
}

}  // namespace usher::global_planner
