#include "navigation/local_planner/core/reference_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

namespace usher::local_planner {
namespace {

constexpr std::size_t kMostPoses = 100000;
constexpr double kSamePoint = 1e-4;   // [m] poses closer than this are one corner
constexpr double kSearchBack = 0.5;   // [m]
constexpr double kSearchAhead = 1.5;  // [m]
constexpr double kLost = 1.0;         // [m] farther away than this the whole path is searched

// Eight points at a time by the compiler's own vectors: the same operations for every instruction
// set, so the same bits. The target attribute of the caller decides what they become.
using Floats = float __attribute__((vector_size(32), aligned(4), may_alias));

[[gnu::always_inline]] inline void nearer(const float* x, const float* y, float* squared,
                                          std::size_t count, const float* side) {
  const float ax = side[0], ay = side[1], dx = side[2], dy = side[3], inverse = side[4];
  const Floats zero = {};
  const Floats one = zero + 1.0F;
  for (std::size_t i = 0; i < count; i += 8) {
    const Floats px = *reinterpret_cast<const Floats*>(x + i) - ax;
    const Floats py = *reinterpret_cast<const Floats*>(y + i) - ay;
    Floats t = (px * dx + py * dy) * inverse;
    t = t > zero ? t : zero;
    t = t < one ? t : one;
    const Floats ex = px - t * dx;
    const Floats ey = py - t * dy;
    const Floats d = ex * ex + ey * ey;
    Floats& best = *reinterpret_cast<Floats*>(squared + i);
    best = d < best ? d : best;
  }
}

void nearer_portable(const float* x, const float* y, float* squared, std::size_t count,
                     const float* side) {
  nearer(x, y, squared, count, side);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void nearer_avx2(const float* x, const float* y, float* squared,
                                                 std::size_t count, const float* side) {
  nearer(x, y, squared, count, side);
}
#else
constexpr auto nearer_avx2 = nearer_portable;
#endif

}  // namespace

Status ReferencePath::set(std::span<const geometry::Pose2> poses) {
  if (poses.empty() || poses.size() > kMostPoses) {
    return Error{"path: expected 1 to " + std::to_string(kMostPoses) + " poses, found " +
                 std::to_string(poses.size())};
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i].finite())
      return Error{"path: expected finite poses, pose " + std::to_string(i) + " is not"};
  }
  clear();
  for (const geometry::Pose2& pose : poses) {
    if (x_.empty()) {
      arc_.push_back(0.0);
    } else {
      const double step = std::hypot(pose.x - x_.back(), pose.y - y_.back());
      if (step < kSamePoint) continue;
      arc_.push_back(arc_.back() + step);
    }
    x_.push_back(pose.x);
    y_.push_back(pose.y);
  }
  goal_ = poses.back();
  return {};
}

void ReferencePath::clear() {
  x_.clear(), y_.clear(), arc_.clear();
  progress_ = 0.0;
}

std::size_t ReferencePath::segment_at(double arc) const {
  const auto next = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, arc);
  return static_cast<std::size_t>(next - arc_.begin()) - 1;
}

void ReferencePath::project(const geometry::Point2& position, double from, double to,
                            double& best_arc, double& best_squared) const {
  best_squared = std::numeric_limits<double>::infinity();
  for (std::size_t i = segment_at(from); i + 1 < x_.size() && arc_[i] <= to; ++i) {
    const double dx = x_[i + 1] - x_[i];
    const double dy = y_[i + 1] - y_[i];
    const double side = arc_[i + 1] - arc_[i];
    const double along = ((position.x() - x_[i]) * dx + (position.y() - y_[i]) * dy) / side;
    const double s = std::clamp(along, std::max(0.0, from - arc_[i]), std::min(side, to - arc_[i]));
    const double ex = x_[i] + dx * (s / side) - position.x();
    const double ey = y_[i] + dy * (s / side) - position.y();
    const double squared = ex * ex + ey * ey;
    if (squared < best_squared) best_squared = squared, best_arc = arc_[i] + s;
  }
}

void ReferencePath::advance(const geometry::Point2& position) {
  if (x_.size() < 2) return;
  double arc = progress_;
  double squared = 0.0;
  project(position, std::max(0.0, progress_ - kSearchBack),
          std::min(length(), progress_ + kSearchAhead), arc, squared);
  if (squared > kLost * kLost) project(position, 0.0, length(), arc, squared);
  progress_ = arc;
}

geometry::Point2 ReferencePath::point(double arc) const {
  assert(!empty());
  if (x_.size() < 2) return {x_[0] + arc * std::cos(goal_.yaw), y_[0] + arc * std::sin(goal_.yaw)};
  const std::size_t i = segment_at(arc);
  const double fraction = (arc - arc_[i]) / (arc_[i + 1] - arc_[i]);
  return {x_[i] + fraction * (x_[i + 1] - x_[i]), y_[i] + fraction * (y_[i + 1] - y_[i])};
}

geometry::Pose2 ReferencePath::at(double arc) const {
  const geometry::Point2 p = point(arc);
  if (x_.size() < 2) return {p.x(), p.y(), goal_.yaw};
  const std::size_t i = segment_at(arc);
  return {p.x(), p.y(), std::atan2(y_[i + 1] - y_[i], x_[i + 1] - x_[i])};
}

void PolylineDistance::add(float ax, float ay, float bx, float by) {
  const float dx = bx - ax;
  const float dy = by - ay;
  const float squared = dx * dx + dy * dy;
  sides_.push_back({ax, ay, dx, dy, squared > 1e-12F ? 1.0F / squared : 0.0F});
}

void PolylineDistance::measure(std::span<const float> x, std::span<const float> y,
                               std::span<float> distances) const {
  assert(x.size() == y.size() && x.size() == distances.size() && x.size() % 8 == 0);
  std::fill(distances.begin(), distances.end(), std::numeric_limits<float>::infinity());
  const auto kernel = avx2_ ? nearer_avx2 : nearer_portable;
  for (const Side& side : sides_) {
    kernel(x.data(), y.data(), distances.data(), x.size(), side.data());
  }
  for (float& d : distances) d = std::sqrt(d);
}

}  // namespace usher::local_planner
