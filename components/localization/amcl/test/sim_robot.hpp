#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "foundation/grid/distance_field.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/random/random.hpp"
#include "localization/amcl/core/laser_beams.hpp"

namespace usher::amcl {

/// A building of 24 m x 14 m with a corridor and six different rooms, furniture included; two rooms
/// share their shape, as in life.
inline grid::OccupancyGrid small_building() {
  grid::OccupancyGrid map({480, 280, 0.05, -3.0, -2.0}, grid::kFree);
  const auto wall = [&map](double x0, double y0, double x1, double y1) {
    const grid::Cell a = map.geometry().cell_at(x0 - 3.0, y0 - 2.0);
    const grid::Cell b = map.geometry().cell_at(x1 - 3.0, y1 - 2.0);
    for (int y = a.y; y <= b.y; ++y) {
      for (int x = a.x; x <= b.x; ++x) {
        if (map.geometry().contains({x, y})) map.at({x, y}) = grid::kOccupied;
      }
    }
  };
  wall(0, 0, 24, 0.1), wall(0, 13.9, 24, 14), wall(0, 0, 0.1, 14), wall(23.9, 0, 24, 14);
  wall(0, 6, 3, 6.1), wall(4, 6, 10, 6.1), wall(11, 6, 19, 6.1), wall(20, 6, 24, 6.1);
  wall(0, 8, 5, 8.1), wall(6, 8, 13, 8.1), wall(14, 8, 21, 8.1), wall(22, 8, 24, 8.1);
  wall(7, 0, 7.1, 6), wall(15, 0, 15.1, 6), wall(9, 8, 9.1, 14), wall(18, 8, 18.1, 14);
  wall(1, 1, 2.5, 1.8), wall(5, 3, 6, 4.2), wall(12, 1.5, 13, 3), wall(19.5, 1, 22, 1.7),
      wall(17, 4, 17.6, 4.6);
  wall(2, 11, 4, 12.2), wall(11, 12, 15, 12.8), wall(15.5, 9, 16.2, 10), wall(20, 11.5, 21, 13),
      wall(1, 6.1, 1.8, 6.5);
  return map;
}

/// A robot that wanders through free space, with wheels and a laser that err. No dynamics: one
/// call, one step.
class SimRobot {
 public:
  struct Errors {
    double range = 0.012;       // [m] of each reading
    double range_offset = 0.0;  // [m] added to every reading
    double translation = 0.02;  // share of a step
    double rotation = 0.03;     // share of a turn
    double drift = 0.01;        // [rad/m]
  };

  SimRobot(const grid::OccupancyGrid& map, const geometry::Pose2& start, std::uint64_t seed)
      : SimRobot(map, start, seed, Errors{}) {}
  SimRobot(const grid::OccupancyGrid& map, const geometry::Pose2& start, std::uint64_t seed,
           const Errors& errors)
      : pose_(start), random_(seed), errors_(errors), ranges_(181) {
    field_.build(map, 2.0);
  }

  /// A random place with room around it, inside the building: walls in nearly every direction.
  static geometry::Pose2 free_place(const grid::OccupancyGrid& map, Random& random) {
    grid::DistanceField field;
    field.build(map, 1.0);
    while (true) {
      const grid::Cell cell = map.geometry().cell(random.below(map.size()));
      if (map.at(cell) != grid::kFree || field.distance(cell) < 0.4) continue;
      const geometry::Point2 center = map.geometry().center(cell);
      int walls = 0;
      for (int i = 0; i < 36; ++i)
        walls += field.cast_ray(center, i * geometry::kPi / 18, 15.0).has_value();
      if (walls >= 34) return {center.x(), center.y(), random.uniform(-3.0, 3.0)};
    }
  }

  /// 0.1 m ahead, or a turn where that is blocked.
  void step() {
    double ahead = 10.0;
    for (const double side : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const auto hit = field_.cast_ray(pose_.position(), pose_.yaw + side, 10.0);
      ahead = std::min(ahead, hit ? hit->range : 0.0);  // not out into the open
    }
    if (ahead < 0.6) {
      move({0.0, 0.0, turn_});
    } else {
      if (random_.uniform() < 0.02) turn_ = -turn_;
      move({0.1, 0.0, random_.uniform(-0.04, 0.04)});
    }
  }

  void move(const geometry::Pose2& body_step) {
    pose_ = pose_ * body_step;
    geometry::Pose2 seen = body_step;
    seen.x *= 1.0 + errors_.translation * random_.gaussian();
    seen.yaw *= 1.0 + errors_.rotation * random_.gaussian();
    seen.yaw += errors_.drift * std::hypot(body_step.x, body_step.y);
    odometry_ = odometry_ * seen;
  }

  /// The world carries it away; its wheels see nothing.
  void kidnap(const geometry::Pose2& to) { pose_ = to; }

  /// 181 beams over the front half, up to 20 m.
  LaserBeams scan() {
    const geometry::Pose2 laser = pose_ * base_T_laser();
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      const double angle = -0.5 * geometry::kPi + static_cast<double>(i) * geometry::kPi / 180.0;
      const auto hit = field_.cast_ray(laser.position(), laser.yaw + angle, 20.0);
      // A surface lies somewhere in its cell: half a cell behind the border on average.
      ranges_[i] = hit ? static_cast<float>(hit->range + 0.025 + errors_.range_offset +
                                            errors_.range * random_.gaussian())
                       : 20.0F;
    }
    return {base_T_laser(), -0.5 * geometry::kPi, geometry::kPi / 180.0, 0.05, 20.0, ranges_};
  }

  static geometry::Pose2 base_T_laser() { return {0.2, 0.0, 0.0}; }
  const geometry::Pose2& pose() const { return pose_; }
  const geometry::Pose2& odometry() const { return odometry_; }
  std::vector<float>& ranges() { return ranges_; }

 private:
  grid::DistanceField field_;
  geometry::Pose2 pose_, odometry_{5.0, -3.0, 1.0};
  Random random_;
  Errors errors_;
  double turn_ = 0.15;
  std::vector<float> ranges_;
};

}  // namespace usher::amcl
