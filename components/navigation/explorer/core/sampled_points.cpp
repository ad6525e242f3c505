#include "navigation/explorer/core/sampled_points.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/sampling.hpp"

namespace usher::explorer {

namespace {

/// Chains the points: the nearest to `from` first, then the nearest to that one; equally near ones
/// in their order. O(points^2).
void chain(Point2 from, std::vector<Point2>& points) {
  for (auto first = points.begin(); first != points.end(); ++first) {
    const auto nearest = std::min_element(first, points.end(), [&](const auto& a, const auto& b) {
      return (a - from).squaredNorm() < (b - from).squaredNorm();
    });
    std::iter_swap(first, nearest);
    from = *first;
  }
}

}  // namespace

void SampledPoints::begin_round() {
  level_ = 0;
  points_.clear();
  next_ = 0;
}

void SampledPoints::sample(const Outlook& outlook, double side) {
  const Ground& ground = outlook.ground;
  grid::SamplingParameters parameters;
  parameters.sampling =
      config_.kind == StrategyKind::kGrid ? grid::Sampling::kGrid : grid::Sampling::kCell;
  parameters.cell_size = parameters.grid_step = side;
  parameters.points_per_cell = 1;
  grid::sample_points(ground.standing(), ground.standing_map(), parameters, random_, points_);
  std::erase_if(points_, [&](const Point2& point) {
    return !std::isfinite(ground.way_to(point)) || outlook.seen.aside(point);
  });
  chain(outlook.robot.position(), points_);
  next_ = 0;
}

std::optional<Pose2> SampledPoints::next(const Outlook& outlook) {
  while (true) {
    if (next_ == points_.size()) {
      if (level_ == config_.levels.size()) return std::nullopt;
      sample(outlook, config_.levels[level_++]);
      continue;
    }
    const Point2 point = points_[next_++];
    if (is_given_up(outlook, point, config_.give_up_radius) ||
        !std::isfinite(outlook.ground.way_to(point)))
      continue;
    const bool last = next_ == points_.size();
    const Point2 way = last ? Point2(point - outlook.robot.position()) : points_[next_] - point;
    return Pose2{point.x(), point.y(), std::atan2(way.y(), way.x())};
  }
}

}  // namespace usher::explorer
