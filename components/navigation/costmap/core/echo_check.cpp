#include "navigation/costmap/core/echo_check.hpp"

#include <cmath>
#include <limits>

namespace usher::costmap {

void drop_explained_echoes(const ComparedScan& laser, const ComparedScan& sonar, double half_cone,
                           double tolerance, std::span<float> echoes) {
  const geometry::Pose2 sonar_T_laser = geometry::inverse(sonar.sensor) * laser.sensor;
  for (std::size_t beam = 0; beam < laser.ranges.size(); ++beam) {
    const double range = laser.ranges[beam];
    if (!std::isfinite(range) || range <= 0.0) continue;
    const double angle = laser.angle_min + laser.angle_increment * static_cast<double>(beam);
    const geometry::Point2 end =
        sonar_T_laser * geometry::Point2(range * std::cos(angle), range * std::sin(angle));
    const double distance = end.norm();
    const double bearing = std::atan2(end.y(), end.x());
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const double axis = sonar.angle_min + sonar.angle_increment * static_cast<double>(i);
      if (std::isfinite(echoes[i]) && distance <= echoes[i] + tolerance &&
          std::abs(geometry::shortest_turn(axis, bearing)) <= half_cone) {
        echoes[i] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

}  // namespace usher::costmap
