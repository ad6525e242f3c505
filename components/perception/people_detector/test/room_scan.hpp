#pragma once

#include <cmath>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::people_detector {

/// A scan in a room of 6 x 4 m whose walls alone are on the map.
struct RoomScan {
  struct Disc {
    geometry::Point2 center;
    double radius;  ///< [m]
  };
  double angle_min = -2.35, increment = 0.0087;  ///< [rad]
  std::vector<float> ranges;
};

inline grid::OccupancyGrid room_map() {
  grid::OccupancyGrid map({130, 90, 0.05, -0.25, -0.25}, grid::kFree);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const geometry::Point2 p = map.geometry().center(map.geometry().cell(i));
    if (p.x() < 0.0 || p.y() < 0.0 || p.x() > 6.0 || p.y() > 4.0) map[i] = grid::kOccupied;
  }
  return map;
}

inline RoomScan scan_room(const geometry::Pose2& sensor, const std::vector<RoomScan::Disc>& discs) {
  RoomScan scan;
  for (int i = 0; i < 541; ++i) {
    const double angle = sensor.yaw + scan.angle_min + i * scan.increment;
    const geometry::Point2 along(std::cos(angle), std::sin(angle));
    double range = 10.0;
    if (along.x() > 0.0) range = std::min(range, (6.0 - sensor.x) / along.x());
    if (along.x() < 0.0) range = std::min(range, -sensor.x / along.x());
    if (along.y() > 0.0) range = std::min(range, (4.0 - sensor.y) / along.y());
    if (along.y() < 0.0) range = std::min(range, -sensor.y / along.y());
    for (const auto& disc : discs) {
      const geometry::Point2 to = disc.center - sensor.position();
      const double beside = to.x() * along.y() - to.y() * along.x();
      if (to.dot(along) <= 0.0 || std::abs(beside) > disc.radius) continue;
      range =
          std::min(range, to.dot(along) - std::sqrt(disc.radius * disc.radius - beside * beside));
    }
    scan.ranges.push_back(static_cast<float>(range));
  }
  return scan;
}

}  // namespace usher::people_detector
