#include "navigation/navigator/core/route.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace usher::navigator {
namespace {
constexpr double kBehind = 0.5;      // [m]
constexpr double kAhead = 3.0;       // [m]
constexpr double kChord = 0.4;       // [m]
constexpr double kLostOffset = 1.0;  // [m]
}  // namespace

void Route::set(std::vector<geometry::Pose2> path) {
  assert(!path.empty());
  path_ = std::move(path);
  length_.assign(1, 0.0);
  for (std::size_t i = 1; i < path_.size(); ++i)
    length_.push_back(length_.back() + geometry::distance(path_[i - 1], path_[i]));
  place_ = offset_ = 0.0;
  measure_chords();
}

/// A last piece shorter than a chord has no heading of its own.
void Route::measure_chords() {
  chords_.clear();
  geometry::Point2 begin = path_.front().position();
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const double end = kChord * static_cast<double>(chords_.size() + 1);
    if (length_[i] < end) continue;
    const geometry::Point2 way = path_[i].position() - begin;
    chords_.resize(static_cast<std::size_t>(length_[i] / kChord), std::atan2(way.y(), way.x()));
    begin = path_[i].position();
  }
}

double Route::heading() const {
  const auto chord = static_cast<std::size_t>(place_ / kChord);
  return chord < chords_.size() ? chords_[chord] : path_.back().yaw;
}

double Route::turning_left(double yaw) const {
  double turning = 0.0;
  for (auto i = static_cast<std::size_t>(place_ / kChord); i < chords_.size(); ++i) {
    turning += std::abs(geometry::shortest_turn(yaw, chords_[i]));
    yaw = chords_[i];
  }
  return turning + std::abs(geometry::shortest_turn(yaw, path_.back().yaw));
}

Route::Projection Route::project(const geometry::Point2& point, double from, double to) const {
  Projection best{0.0, std::numeric_limits<double>::infinity()};
  const auto after = [&](double place) {
    return static_cast<std::size_t>(std::upper_bound(length_.begin(), length_.end(), place) -
                                    length_.begin());
  };
  const std::size_t first = std::max<std::size_t>(after(from), 1) - 1;
  const std::size_t last = std::min(after(to), path_.size() - 1);
  for (std::size_t i = first; i <= last; ++i) {
    const geometry::Point2 a = path_[i].position();
    const geometry::Point2 along = (i < last ? path_[i + 1].position() : a) - a;
    const double squared = along.squaredNorm();
    const double part =
        squared > 0.0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0.0;
    const double distance = (a + part * along - point).norm();
    if (distance < best.distance) best = {length_[i] + part * std::sqrt(squared), distance};
  }
  return best;
}

double Route::track(const geometry::Pose2& robot) {
  Projection found = project(robot.position(), place_ - kBehind, place_ + kAhead);
  if (found.distance > kLostOffset) found = project(robot.position(), 0.0, length());
  const double advance = found.place - place_;
  place_ = found.place;
  offset_ = found.distance;
  return advance;
}

}  // namespace usher::navigator
