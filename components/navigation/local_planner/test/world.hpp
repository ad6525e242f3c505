#pragma once

// A small world for closed-loop tests: boxes and discs, their cost grid, a grid path, a base that
// lags.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "navigation/local_planner/core/dynamic_window.hpp"

namespace usher::local_planner::testing_world {

using geometry::Point2;
using geometry::Pose2;
using geometry::Twist2;
using Costs = grid::Grid<std::uint8_t>;

struct Box {
  double x0, y0, x1, y1;
};
struct Disc {
  double x, y, radius;
};

class World {
 public:
  World(double x0, double y0, double x1, double y1, double resolution = 0.05)
      : costs_({static_cast<int>(std::lround((x1 - x0) / resolution)),
                static_cast<int>(std::lround((y1 - y0) / resolution)), resolution, x0, y0}) {}

  void add(const Box& box) { boxes_.push_back(box); }
  void add(const Disc& disc) { discs_.push_back(disc); }

  /// Marks every cell that an obstacle touches as lethal and inflates like costmap_2d.
  void finish(double inscribed, double inflation = 0.55, double scaling = 6.0) {
    const grid::GridGeometry& g = costs_.geometry();
    for (std::uint8_t& c : costs_) c = 0;
    std::vector<grid::Cell> lethal;
    const double h = 0.5 * g.resolution - 1e-9;
    for (int y = 0; y < g.height; ++y) {
      for (int x = 0; x < g.width; ++x) {
        const Point2 c = g.center({x, y});
        bool hit = false;
        for (const Box& b : boxes_) {
          hit =
              hit || (c.x() + h > b.x0 && c.x() - h < b.x1 && c.y() + h > b.y0 && c.y() - h < b.y1);
        }
        for (const Disc& d : discs_) {
          const double dx = std::max(0.0, std::abs(c.x() - d.x) - h);
          const double dy = std::max(0.0, std::abs(c.y() - d.y) - h);
          hit = hit || std::hypot(dx, dy) < d.radius;
        }
        if (hit) lethal.push_back({x, y});
      }
    }
    const int reach = static_cast<int>(std::ceil(inflation / g.resolution));
    for (const grid::Cell& cell : lethal) {
      for (int dy = -reach; dy <= reach; ++dy) {
        for (int dx = -reach; dx <= reach; ++dx) {
          const grid::Cell near{cell.x + dx, cell.y + dy};
          const double distance = std::hypot(dx, dy) * g.resolution;
          if (!g.contains(near) || distance > inflation) continue;
          std::uint8_t cost = grid::kLethalCost;
          if (dx != 0 || dy != 0) {
            cost = distance <= inscribed ? grid::kInscribedCost
                                         : static_cast<std::uint8_t>(
                                               252.0 * std::exp(-scaling * (distance - inscribed)));
          }
          costs_.at(near) = std::max(costs_.at(near), cost);
        }
      }
    }
  }

  const Costs& costs() const { return costs_; }

  /// The window of `side` metres around a position, aligned with the world's cells; beyond the
  /// world all is lethal.
  void window(const Pose2& pose, double side, Costs& local) const {
    const grid::GridGeometry& g = costs_.geometry();
    const int cells = static_cast<int>(std::lround(side / g.resolution));
    const grid::Cell center = g.cell_at(pose.x, pose.y);
    const grid::Cell first{center.x - cells / 2, center.y - cells / 2};
    if (local.width() != cells) local = Costs({cells, cells, g.resolution, 0.0, 0.0});
    local.set_origin(g.origin_x + first.x * g.resolution, g.origin_y + first.y * g.resolution);
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x)
        local.at({x, y}) = costs_.value_or({first.x + x, first.y + y}, grid::kLethalCost);
    }
  }

  /// Distance from the outline at a pose to the nearest real obstacle (not to its cells); zero is a
  /// contact.
  double clearance(const Footprint& footprint, const Pose2& pose) const {
    double nearest = 10.0;
    const double reach = footprint.circumscribed_radius();
    for (const Disc& d : discs_) {
      if (std::hypot(d.x - pose.x, d.y - pose.y) > reach + d.radius + 0.5) continue;
      nearest = std::min(nearest, footprint.distance(inverse(pose) * Point2(d.x, d.y)) - d.radius);
    }
    for (const Box& b : boxes_) {
      const double dx = std::max({b.x0 - pose.x, pose.x - b.x1, 0.0});
      const double dy = std::max({b.y0 - pose.y, pose.y - b.y1, 0.0});
      if (std::hypot(dx, dy) > reach + 0.3) continue;
      nearest = std::min(nearest, box_distance(footprint, pose, b));
    }
    return std::max(0.0, nearest);
  }

  /// A path of cell centers with costs below the inscribed ones, the costs counting as detours;
  /// smoothed a little.
  std::optional<std::vector<Pose2>> plan(const Pose2& start, const Pose2& goal,
                                         double cost_weight = 3.0) const;

 private:
  static double box_distance(const Footprint& footprint, const Pose2& pose, const Box& b) {
    std::vector<Point2> outline;
    for (const Point2& c : footprint.corners()) outline.push_back(pose * c);
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < outline.size();
         ++i) {  // samples of the outline against the box, exact to 5 mm
      const Point2 along = outline[(i + 1) % outline.size()] - outline[i];
      const int samples = static_cast<int>(std::ceil(along.norm() / 0.005));
      for (int k = 0; k < samples; ++k) {
        const Point2 p = outline[i] + along * (static_cast<double>(k) / samples);
        const double dx = std::max({b.x0 - p.x(), p.x() - b.x1, 0.0});
        const double dy = std::max({b.y0 - p.y(), p.y() - b.y1, 0.0});
        nearest = std::min(nearest, std::hypot(dx, dy));
      }
    }
    for (const Point2& corner :
         {Point2(b.x0, b.y0), Point2(b.x0, b.y1), Point2(b.x1, b.y0), Point2(b.x1, b.y1)}) {
      nearest = std::min(nearest, footprint.distance(inverse(pose) * corner));
    }
    return nearest;
  }

  Costs costs_;
  std::vector<Box> boxes_;
  std::vector<Disc> discs_;
};

inline std::optional<std::vector<Pose2>> World::plan(const Pose2& start, const Pose2& goal,
                                                     double cost_weight) const {
  const grid::GridGeometry& g = costs_.geometry();
  const std::size_t from = g.index(g.cell_at(start.x, start.y));
  const std::size_t to = g.index(g.cell_at(goal.x, goal.y));
  std::vector<double> best(g.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> parent(g.size(), from);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  best[from] = 0.0;
  open.emplace(0.0, from);
  while (!open.empty()) {
    const auto [estimate, index] = open.top();
    open.pop();
    if (index == to) break;
    const grid::Cell cell = g.cell(index);
    for (int k = 0; k < 9; ++k) {
      const grid::Cell next{cell.x + k % 3 - 1, cell.y + k / 3 - 1};
      if (!g.contains(next) || costs_.at(next) >= grid::kInscribedCost) continue;
      const double step =
          std::hypot(k % 3 - 1, k / 3 - 1) * (1.0 + cost_weight * costs_.at(next) / 252.0);
      const std::size_t at = g.index(next);
      if (best[index] + step >= best[at]) continue;
      best[at] = best[index] + step;
      parent[at] = index;
      const grid::Cell target = g.cell(to);
      open.emplace(best[at] + std::hypot(next.x - target.x, next.y - target.y), at);
    }
  }
  if (!std::isfinite(best[to])) return std::nullopt;
  std::vector<Pose2> path;
  for (std::size_t i = to; i != from; i = parent[i])
    path.push_back({g.center(g.cell(i)).x(), g.center(g.cell(i)).y(), 0});
  path.push_back(start);
  std::reverse(path.begin(), path.end());
  path.back() = goal;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = 1; i + 1 < path.size(); ++i) {
      path[i].x = 0.25 * path[i - 1].x + 0.5 * path[i].x + 0.25 * path[i + 1].x;
      path[i].y = 0.25 * path[i - 1].y + 0.5 * path[i].y + 0.25 * path[i + 1].y;
    }
  }
  return path;
}

/// Where somebody is now, as a sensor would mark it.
inline void mark(const MovingDisc& disc, double inscribed, Costs& costs, double inflation = 0.55,
                 double scaling = 6.0) {
  const grid::GridGeometry& g = costs.geometry();
  const double reach = disc.radius + inflation;
  const grid::Cell first = g.cell_at(disc.position - Point2(reach, reach));
  const grid::Cell last = g.cell_at(disc.position + Point2(reach, reach));
  for (int y = std::max(0, first.y); y <= std::min(last.y, g.height - 1); ++y) {
    for (int x = std::max(0, first.x); x <= std::min(last.x, g.width - 1); ++x) {
      const double off = (g.center({x, y}) - disc.position).norm() - disc.radius;
      if (off > inflation) continue;
      std::uint8_t cost = grid::kLethalCost;
      if (off > 0.5 * g.resolution) {
        cost = off <= inscribed
                   ? grid::kInscribedCost
                   : static_cast<std::uint8_t>(252.0 * std::exp(-scaling * (off - inscribed)));
      }
      costs.at({x, y}) = std::max(costs.at({x, y}), cost);
    }
  }
}

/// A base that follows commands after a dead time as a first-order lag with a bounded acceleration.
struct Base {
  double dead_time = 0.0;
  double lag = 0.5;
  double turn_lag = 0.2;
  double acceleration = 1.0;
  double angular_acceleration = 3.0;

  Pose2 pose;
  Twist2 twist;
  std::vector<Twist2> in_flight = {};

  void step(const Twist2& command, double dt) {
    in_flight.push_back(command);
    const auto delay = static_cast<std::size_t>(std::lround(dead_time / dt));
    Twist2 acting;
    if (in_flight.size() > delay) acting = in_flight[in_flight.size() - 1 - delay];
    const Twist2 before = twist;
    twist.v += std::clamp((acting.v - twist.v) / lag, -acceleration, acceleration) * dt;
    twist.w +=
        std::clamp((acting.w - twist.w) / turn_lag, -angular_acceleration, angular_acceleration) *
        dt;
    pose = integrate(pose, {0.5 * (before.v + twist.v), 0.5 * (before.w + twist.w)}, dt);
  }
};

struct Drive {
  bool reached = false;
  bool contact = false;     // the outline met a real obstacle while the base moved
  double clearance = 10.0;  // smallest
  double seconds = 0.0;
  double way = 0.0;
  double fastest = 0.0;
  double largest_step = 0.0;  // of the speed command in one cycle
  int turn_reversals = 0;     // changes of the turn command's sign beyond +-0.1 rad/s
  int blocked_cycles = 0;
  Decision last;
  Pose2 end;
  Pose2 closest;  // where the clearance was smallest, and why the base moved
  Reason closest_reason = Reason::kNoPath;
  int tight_cycles = 0;
  std::vector<Pose2> trace;
  double mean_speed() const { return seconds > 0.0 ? way / seconds : 0.0; }
};

/// Drives until the goal is reached, or `limit` seconds are over, or blocked for `patience`
/// seconds. People walk on without looking; the planner knows them, and the costs where they are.
inline Drive drive(DynamicWindow& planner, const World& world, Base& base, double limit,
                   double patience = 5.0, double window = 6.0,
                   std::span<const MovingDisc> people = {}) {
  constexpr double kCycle = 0.05;
  constexpr int kSubsteps = 10;
  Drive result;
  Costs local;
  Twist2 command;
  std::vector<MovingDisc> discs(people.begin(), people.end());
  double blocked = 0.0;
  double last_turn = 0.0;
  while (result.seconds < limit) {
    world.window(base.pose, window, local);
    for (const MovingDisc& disc : discs)
      mark(disc, planner.config().footprint.inscribed_radius(), local);
    const Decision decision = planner.decide(local, base.pose, base.twist, command, kCycle, discs);
    result.largest_step = std::max(result.largest_step, std::abs(decision.command.v - command.v));
    command = decision.command;
    if (std::abs(command.w) > 0.1) {
      if (command.w * last_turn < 0.0) ++result.turn_reversals;
      last_turn = command.w;
    }
    result.last = decision;
    result.blocked_cycles += decision.blocked;
    result.tight_cycles += decision.reason == Reason::kTight;
    blocked = decision.blocked ? blocked + kCycle : 0.0;
    if (decision.reached || blocked > patience) break;
    for (int i = 0; i < kSubsteps; ++i) {
      base.step(command, kCycle / kSubsteps);
      for (MovingDisc& disc : discs) disc.position += disc.velocity * (kCycle / kSubsteps);
    }
    result.seconds += kCycle;
    result.way += std::abs(base.twist.v) * kCycle;
    result.fastest = std::max(result.fastest, base.twist.v);
    double clearance = world.clearance(planner.config().footprint, base.pose);
    for (const MovingDisc& disc : discs) {
      const Point2 p = inverse(base.pose) * disc.position;
      clearance =
          std::min(clearance, std::max(0.0, planner.config().footprint.distance(p) - disc.radius));
    }
    if (clearance < result.clearance) {
      result.clearance = clearance, result.closest = base.pose,
      result.closest_reason = decision.reason;
    }
    const bool moves = std::abs(base.twist.v) > 0.02 || std::abs(base.twist.w) > 0.05;
    if (clearance <= 0.0 && moves) result.contact = true;
    result.trace.push_back(base.pose);
  }
  result.reached = result.last.reached;
  result.end = base.pose;
  return result;
}

}  // namespace usher::local_planner::testing_world
