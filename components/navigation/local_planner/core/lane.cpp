#include "navigation/local_planner/core/lane.hpp"

#include <algorithm>
#include <cmath>

namespace usher::local_planner {

namespace {

using geometry::Point2;

constexpr double kSight = 5.0;     // [m] of path ahead
constexpr double kBehind = 0.5;    // [m] of path
constexpr double kStep = 0.1;      // [m] between two shifts
constexpr int kAround = 6;         // shifts to either side whose room counts
constexpr double kMost = 0.3;      // [m]
constexpr double kBeside = 1.0;    // [m] from the path: still comes along it
constexpr double kComes = 0.25;    // [m/s] against the path's direction
constexpr double kPatience = 1.5;  // [s] after the last one came

bool comes_along(const ReferencePath& path, const MovingDisc& disc) {
  for (double arc = path.progress(); arc < path.progress() + kSight; arc += 0.25) {
    const geometry::Pose2 at = path.at(arc);
    if ((disc.position - at.position()).norm() > kBeside) continue;
    const Point2 along(std::cos(at.yaw), std::sin(at.yaw));
    if (disc.velocity.dot(along) < -kComes) return true;
  }
  return false;
}

}  // namespace

Point2 Lane::aside(double yaw) const { return side_ * Point2(std::sin(yaw), -std::cos(yaw)); }

/// Free way to the side of a point of the path [m], no farther than needed.
double Lane::room(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& at) const {
  const grid::GridGeometry& g = costs.geometry();
  const Point2 out = aside(at.yaw);
  const double enough = half_width_ + gap_ + kMost;
  for (double way = 0.0; way < enough; way += 0.5 * g.resolution) {
    const grid::Cell cell = g.cell_at(at.position() + way * out);
    if (g.contains(cell) && costs.at(cell) == grid::kLethalCost) return way;
  }
  return enough;
}

void Lane::choose(const ReferencePath& path, const grid::Grid<std::uint8_t>& costs,
                  std::span<const MovingDisc> discs, double seconds) {
  left_ -= seconds;
  if (std::any_of(discs.begin(), discs.end(),
                  [&](const MovingDisc& disc) { return comes_along(path, disc); }))
    left_ = kPatience;
  shifts_.clear();
  if (left_ <= 0.0) return;
  start_ = path.progress() - kBehind;
  const auto count = static_cast<std::size_t>((kBehind + kSight) / kStep);
  rooms_.resize(count), shifts_.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    rooms_[i] = room(costs, path.at(start_ + static_cast<double>(i) * kStep)) - half_width_ - gap_;
  // As little as around it, and in the middle of where the path ends.
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i < kAround ? 0 : i - kAround;
    const std::size_t last = std::min(count, i + kAround + 1);
    const double least = *std::min_element(rooms_.begin() + static_cast<std::ptrdiff_t>(first),
                                           rooms_.begin() + static_cast<std::ptrdiff_t>(last));
    const double remaining = path.length() - (start_ + static_cast<double>(i) * kStep);
    shifts_[i] = std::clamp(std::min(least, 0.5 * (remaining - kBehind)), 0.0, kMost);
  }
}

double Lane::shift(double arc) const {
  if (shifts_.empty()) return 0.0;
  const double at =
      std::clamp((arc - start_) / kStep, 0.0, static_cast<double>(shifts_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), shifts_.size() - 1);
  const std::size_t next = std::min(i + 1, shifts_.size() - 1);
  return shifts_[i] + (at - static_cast<double>(i)) * (shifts_[next] - shifts_[i]);
}

Point2 Lane::point(const ReferencePath& path, double arc) const {
  if (shifts_.empty()) return path.point(arc);
  const geometry::Pose2 at = path.at(arc);
  return at.position() + shift(arc) * aside(at.yaw);
}

}  // namespace usher::local_planner
