#include "control/movement_control/core/surroundings.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::movement_control {

using geometry::Point2;

namespace {

constexpr std::size_t kMostPoints = 4096, kMostRemembered = 1024;
constexpr double kApart = 0.005;    // [m] between the points of a wall's rest: no corner fits in
constexpr double kBehind = 0.1;     // [m] a beam that ends so much nearer hides what is behind
constexpr double kUnsure = 0.02;    // [m] of where something remembered is, beside a beam
constexpr double kSurface = 0.1;    // [m] two beams' ends on one surface are no farther apart
constexpr double kWall = 0.4;       // [m] of a wall is looked at to continue it
constexpr double kLeastWall = 0.1;  // [m]
constexpr double kFlat = 0.02;      // [m] a wall's points are no farther from its line, on the mean
constexpr double kBeside = 1.0;     // [m] walls farther away are of no concern

}  // namespace

Surroundings::Surroundings(const Parameters& parameters) : parameters_(parameters) {
  assert(parameters.horizon > 0.0 && parameters.near > 0.0 && parameters.continued >= 0.0);
  points_.reserve(kMostPoints);
  near_.reserve(kMostRemembered);
  hidden_.reserve(kMostRemembered);
}

Point2 Surroundings::end_of(const ScanView& scan, std::size_t beam) const {
  const double angle = scan.angle_min + scan.angle_increment * static_cast<double>(beam);
  const double range = std::max(static_cast<double>(scan.ranges[beam]), 0.0);  // -infinity: at it
  return parameters_.base_T_sensor * Point2(range * std::cos(angle), range * std::sin(angle));
}

void Surroundings::move(const std::optional<geometry::Twist2>& measured, Time now) {
  const Time step = moved_at_ ? std::max(now - *moved_at_, Time::zero()) : Time::zero();
  moved_at_ = now;
  if (!measured || !measured->finite()) return;
  const double seconds = std::chrono::duration<double>(step).count();
  way_ += std::abs(measured->v) * seconds;
  turn_ += std::abs(measured->w) * seconds;
  const geometry::Pose2 new_T_old = geometry::inverse(geometry::integrate({}, *measured, seconds));
  const double c = std::cos(new_T_old.yaw), s = std::sin(new_T_old.yaw);
  const auto moved = [&](const Point2& p) {
    return Point2(new_T_old.x + c * p.x() - s * p.y(), new_T_old.y + s * p.x() + c * p.y());
  };
  for (Point2& point : points_) point = moved(point);
  for (Remembered& each : near_) each.point = moved(each.point);
  for (Remembered& each : hidden_) each.point = moved(each.point);
}

void Surroundings::forget() {
  points_.clear();
  seen_ = 0;
  near_.clear();
  hidden_.clear();
}

/// The scan does not tell whether it is still there.
bool Surroundings::hidden(const ScanView& scan, const Remembered& each, Time now) const {
  if (way_ - each.way > parameters_.longest_way || turn_ - each.turn > parameters_.longest_turn)
    return false;
  const Point2 seen = geometry::inverse(parameters_.base_T_sensor) * each.point;
  const double distance = seen.norm();
  const double angle = std::atan2(seen.y(), seen.x()) - scan.angle_min;
  const double beam = std::round(angle / scan.angle_increment);
  const auto count = static_cast<double>(scan.ranges.size());
  if (!(beam >= 0.0 && beam < count)) return now - each.seen <= parameters_.longest;
  const double width = std::atan2(kUnsure, distance);
  const auto beam_at = [&](double at) {
    return static_cast<std::size_t>(
        std::clamp(std::round(at / scan.angle_increment), 0.0, count - 1.0));
  };
  const auto beams = scan.ranges.subspan(beam_at(angle - width),
                                         beam_at(angle + width) - beam_at(angle - width) + 1);
  return std::ranges::any_of(
      beams, [&](float range) { return std::isnan(range) || range < distance - kBehind; });
}

void Surroundings::remember(const ScanView& scan, Time now) {
  std::erase_if(hidden_, [&](const Remembered& each) { return !hidden(scan, each, now); });
  for (const Remembered& each : near_) {
    if (!hidden(scan, each, now)) continue;
    std::erase_if(hidden_, [&](const Remembered& older) {
      return (older.point - each.point).squaredNorm() < kApart * kApart;
    });
    if (hidden_.size() < kMostRemembered) hidden_.push_back(each);
  }
  near_.clear();
  for (const Point2& point : points_) {
    if (point.norm() <= parameters_.near && near_.size() < kMostRemembered)
      near_.push_back({point, way_, turn_, now});
  }
}

/// The wall at an end of the view, if there is one beside the robot.
void Surroundings::go_on(const ScanView& scan, bool left) {
  const std::size_t count = scan.ranges.size();
  const auto beam = [&](std::size_t i) { return left ? count - 1 - i : i; };
  std::size_t first = 0;
  while (first < count && std::isnan(scan.ranges[beam(first)])) ++first;
  if (first == count || !(scan.ranges[beam(first)] <= kBeside)) return;
  const Point2 end = end_of(scan, beam(first));
  Point2 last = end, sum = Point2::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  double points = 0.0;
  for (std::size_t i = first; i < count; ++i) {
    if (std::isnan(scan.ranges[beam(i)])) continue;
    if (!(scan.ranges[beam(i)] <= parameters_.horizon)) break;
    const Point2 point = end_of(scan, beam(i));
    if ((point - last).norm() > kSurface || (point - end).norm() > kWall) break;
    last = point;
    sum += point;
    squares += point * point.transpose();
    points += 1.0;
  }
  if ((last - end).norm() < kLeastWall) return;
  // The line of least squares, by the greater eigenvector of the points' spread.
  const Point2 mean = sum / points;
  const Eigen::Matrix2d spread = squares / points - mean * mean.transpose();
  const double half = 0.5 * (spread(0, 0) - spread(1, 1));
  const double root = std::hypot(half, spread(0, 1));
  const double least = 0.5 * (spread(0, 0) + spread(1, 1)) - root;
  if (least > kFlat * kFlat) return;
  const double yaw = 0.5 * std::atan2(spread(0, 1), half);
  Point2 along(std::cos(yaw), std::sin(yaw));
  if (along.dot(end - last) < 0.0) along = -along;
  const Point2 from = mean + along * along.dot(end - mean);
  for (double way = kApart; way <= parameters_.continued && points_.size() < kMostPoints;
       way += kApart)
    points_.emplace_back(from + way * along);
}

void Surroundings::take(const ScanView& scan, Time now) {
  if (!std::isfinite(scan.angle_min) || !(scan.angle_increment > 0.0) ||
      !std::isfinite(scan.angle_increment))
    return;
  points_.clear();
  for (std::size_t i = 0; i < scan.ranges.size() && points_.size() < kMostPoints; ++i) {
    if (scan.ranges[i] <= parameters_.horizon) points_.push_back(end_of(scan, i));
  }
  remember(scan, now);
  for (const Remembered& each : hidden_) {
    if (points_.size() < kMostPoints) points_.push_back(each.point);
  }
  seen_ = points_.size();
  go_on(scan, true);
  go_on(scan, false);
}

}  // namespace usher::movement_control
