#include "navigation/costmap/core/echo_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace usher::costmap {

namespace {
constexpr float kArc = 0.9F;     // [m] nearer, the axis alone: arcs beside a door post bar the door
constexpr double kAside = 0.25;  // [m] from a cone's axis
constexpr double kBehind = 0.15;  // [m] both sensors' errors: glass may stand before a wall
constexpr double kBody = 0.6;     // [m] from where somebody is, and the width of a cone
constexpr int kNeighbours = 3;    // beams that agree; glass sends back one now and then
}  // namespace

void drop_explained_echoes(const ComparedScan& laser, const ComparedScan& sonar, double half_cone,
                           double tolerance, std::span<float> echoes) {
  const geometry::Pose2 sonar_T_laser = geometry::inverse(sonar.sensor) * laser.sensor;
  std::vector<int> agree(echoes.size(), 0);
  for (std::size_t beam = 0; beam < laser.ranges.size(); ++beam) {
    const double range = laser.ranges[beam];
    if (!std::isfinite(range) || range <= 0.0) {
      agree.assign(echoes.size(), 0);
      continue;
    }
    const double angle = laser.angle_min + laser.angle_increment * static_cast<double>(beam);
    const geometry::Point2 end =
        sonar_T_laser * geometry::Point2(range * std::cos(angle), range * std::sin(angle));
    const double distance = end.norm();
    const double bearing = std::atan2(end.y(), end.x());
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const double axis = sonar.angle_min + sonar.angle_increment * static_cast<double>(i);
      const double behind = distance - echoes[i];
      const bool explains = behind >= -tolerance && behind <= kBehind &&
                            std::abs(geometry::shortest_turn(axis, bearing)) <= half_cone;
      agree[i] = explains ? agree[i] + 1 : 0;
      if (std::isfinite(echoes[i]) && agree[i] >= kNeighbours)
        echoes[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
}

void drop_remembered_echoes(const ObstacleLayer& laser, const Raster& raster,
                            const geometry::Pose2& window_T_sonar,
                            std::span<const geometry::Point2> rays, double tolerance,
                            std::span<float> echoes) {
  if (echoes.empty()) return;
  const auto occupied = [&](const geometry::Point2& ray, double range) {
    const geometry::Point2 point = window_T_sonar * geometry::Point2(range * ray);
    if (!reachable(point.x(), point.y())) return false;
    const grid::Cell cell = raster.cell_at(point.x(), point.y());
    return laser.states().value_or(cell, kUnseen) == kSeenOccupied;
  };
  const std::size_t beams = rays.size() / echoes.size();
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (!std::isfinite(echoes[i])) continue;
    int agree = 0;
    for (const geometry::Point2& ray : rays.subspan(i * beams, beams)) {
      bool there = false;
      for (double off = -tolerance; off <= tolerance && !there; off += raster.resolution)
        there = occupied(ray, echoes[i] + off);
      agree += there ? 1 : 0;
    }
    if (agree >= kNeighbours) echoes[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

std::vector<geometry::Point2> cone_directions(double angle_min, double angle_increment,
                                              std::size_t sensors, double cone, int beams) {
  std::vector<geometry::Point2> directions;
  directions.reserve(sensors * static_cast<std::size_t>(beams));
  for (std::size_t i = 0; i < sensors; ++i) {
    const double axis = angle_min + angle_increment * static_cast<double>(i);
    for (int k = 0; k < beams; ++k) {
      const double angle = axis + cone * (beams > 1 ? k / (beams - 1.0) - 0.5 : 0.0);
      directions.emplace_back(std::cos(angle), std::sin(angle));
    }
  }
  return directions;
}

void spread_echoes(std::span<const float> echoes, std::span<const geometry::Point2> rays,
                   const geometry::Pose2& window_T_sonar, std::span<const geometry::Point2> people,
                   std::vector<float>& ranges) {
  ranges.assign(rays.size(), std::numeric_limits<float>::quiet_NaN());
  if (echoes.empty()) return;
  const std::size_t beams = rays.size() / echoes.size();
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    const geometry::Point2& axis = rays[i * beams + beams / 2];
    const geometry::Point2 there =
        window_T_sonar * geometry::Point2(std::isfinite(echoes[i]) ? echoes[i] * axis : axis);
    const bool person = std::any_of(people.begin(), people.end(), [&](const auto& each) {
      return (each - there).norm() <= kBody;
    });
    const bool alone = person || echoes[i] < kArc;
    const double reach = std::isfinite(echoes[i]) ? (alone ? 0.0 : kAside / echoes[i]) : 2.0;
    for (std::size_t k = i * beams; k < (i + 1) * beams; ++k)
      if ((rays[k] - axis).norm() <= reach) ranges[k] = echoes[i];
  }
}

void keep_middle(std::span<const geometry::Point2> rays, std::size_t sensors, double width,
                 std::span<float> ranges) {
  if (sensors == 0) return;
  const std::size_t beams = rays.size() / sensors;
  const double least = std::cos(0.5 * width) - 1e-9;  // of a ray along its axis
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const geometry::Point2& axis = rays[i / beams * beams + beams / 2];
    if (rays[i].dot(axis) < least || !(ranges[i] > 0.0F))
      ranges[i] = std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace usher::costmap
