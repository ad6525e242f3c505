#include "perception/people_detector/core/person_ahead.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::people_detector {

namespace {

using geometry::Point2;

constexpr double kBody = 0.25;      // [m] half the breadth of a person
constexpr double kDrives = 0.2;     // [m/s] slower, the robot's arc says nothing of its way
constexpr double kTightest = 1.0;   // [1/m] a turn in place leads nowhere
constexpr double kStraight = 1e-3;  // [1/m]
constexpr double kStep = 0.25;      // [s]

/// Where a point lies along the arc and beside it.
struct OnArc {
  double along, beside;
};
OnArc on_arc(const Point2& point, double curvature) {
  if (std::abs(curvature) < kStraight) return {point.x(), point.y()};
  const double radius = 1.0 / curvature;
  const Point2 from_center = point - Point2(0.0, radius);
  const double side = curvature > 0.0 ? 1.0 : -1.0;
  const double angle = std::atan2(point.x(), -from_center.y() * side);
  return {angle * std::abs(radius), from_center.norm() - std::abs(radius)};
}

}  // namespace

std::optional<PersonInTheWay> person_ahead(std::span<const Track> people, double now,
                                           const geometry::Pose2& odom_T_base,
                                           const geometry::Twist2& twist,
                                           const AheadConfig& config) {
  assert(odom_T_base.finite() && twist.finite());
  const double curvature =
      twist.v < kDrives ? 0.0 : std::clamp(twist.w / twist.v, -kTightest, kTightest);
  const double room = config.half_width + config.beside + kBody;
  const auto in_the_way = [&](const Point2& place) {
    const OnArc at = on_arc(place, curvature);
    const bool close = place.norm() < room && place.x() > -config.half_width;
    return close || (at.along > 0.0 && at.along < config.reach && std::abs(at.beside) < room);
  };
  const geometry::Pose2 base_T_odom = inverse(odom_T_base);
  std::optional<PersonInTheWay> nearest;
  for (const Track& person : people) {
    if (now - person.last_seen() > config.unseen) continue;
    const Point2 place = base_T_odom * person.position();
    bool ahead = false;
    for (double later = 0.0; later <= config.soon && !ahead; later += kStep)
      ahead = in_the_way(base_T_odom * Point2(person.position() + later * person.velocity()));
    const double distance = place.norm();
    if (!ahead || (nearest && nearest->distance <= distance)) continue;
    const Point2 away = person.position() - odom_T_base.position();
    nearest = {distance, std::atan2(place.y(), place.x()),
               -person.velocity().dot(away) / std::max(distance, 1e-3)};
  }
  return nearest;
}

}  // namespace usher::people_detector
