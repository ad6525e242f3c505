#include "foundation/kinematics/stopping_distance.hpp"

#include <cmath>
#include <string>

namespace usher::kinematics {

StoppingDistance::StoppingDistance() : points_{{0.0, 0.0}, {1.0, 1.48}, {1.4, 2.08}} {}

Result<StoppingDistance> StoppingDistance::make(std::span<const StoppingPoint> points) {
  if (points.empty())
    return Error{"stopping distance: expected at least one (speed, distance), found none"};
  std::vector<StoppingPoint> table{{0.0, 0.0}};
  for (const StoppingPoint& point : points) {
    const StoppingPoint& last = table.back();
    const bool grows = point.speed > last.speed && point.distance > last.distance;
    if (!grows || !std::isfinite(point.speed) || !std::isfinite(point.distance)) {
      return Error{
          "stopping distance: speeds and distances must be finite and grow from (0, 0), found (" +
          std::to_string(point.speed) + " m/s, " + std::to_string(point.distance) + " m) after (" +
          std::to_string(last.speed) + " m/s, " + std::to_string(last.distance) +
          " m) before it"};  // what a message ends with in parentheses is a place
    }
    table.push_back(point);
  }
  return StoppingDistance(std::move(table));
}

double StoppingDistance::distance(double speed) const {
  const double magnitude = std::abs(speed);
  std::size_t i = 1;
  while (i + 1 < points_.size() && magnitude > points_[i].speed) ++i;
  const StoppingPoint& a = points_[i - 1];
  const StoppingPoint& b = points_[i];
  return a.distance + (magnitude - a.speed) * (b.distance - a.distance) / (b.speed - a.speed);
}

double StoppingDistance::speed(double distance) const {
  if (!(distance > 0.0)) return 0.0;
  std::size_t i = 1;
  while (i + 1 < points_.size() && distance > points_[i].distance) ++i;
  const StoppingPoint& a = points_[i - 1];
  const StoppingPoint& b = points_[i];
  return a.speed + (distance - a.distance) * (b.speed - a.speed) / (b.distance - a.distance);
}

}  // namespace usher::kinematics
