#pragma once

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "foundation/grid/grid.hpp"
#include "foundation/grid/map_file.hpp"
#include "foundation/random/random.hpp"

namespace usher::amcl {

/// The peers' input: Willow Garage, 1165 x 945 cells of 0.05 m, origin (0, 0), from a bare PGM.
inline grid::OccupancyGrid load_willow(const std::string& pgm_path) {
  std::ifstream file(pgm_path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  const auto image = grid::decode_map_image(
      {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, pgm_path);
  grid::MapDescription description;
  description.resolution = 0.05;
  description.occupied_threshold = 0.65;
  description.free_threshold = 0.196;
  return grid::to_occupancy(image.value(), description);
}

/// The peers' scan generator: a laser that marches in steps of 0.0125 m until an occupied cell,
/// with 0.01 m of noise on what it hit. Unknown cells do not stop a ray. 30 m where nothing was
/// hit.
inline std::vector<float> marched_scan(const grid::OccupancyGrid& map, const geometry::Pose2& laser,
                                       std::uint64_t seed, int beams = 541,
                                       double angle_min = -0.75 * geometry::kPi,
                                       double angle_increment = 1.5 * geometry::kPi / 540) {
  constexpr double kMaxRange = 30.0;
  Random random(seed);
  std::vector<float> ranges;
  for (int i = 0; i < beams; ++i) {
    const double angle = laser.yaw + angle_min + i * angle_increment;
    double range = kMaxRange;
    for (int step = 0; step * 0.0125 < kMaxRange; ++step) {
      const double t = step * 0.0125;
      const auto cell =
          map.geometry().cell_at(laser.x + t * std::cos(angle), laser.y + t * std::sin(angle));
      if (!map.geometry().contains(cell)) break;
      if (map.at(cell) == grid::kOccupied) {
        range = t;
        break;
      }
    }
    const double noise = 0.01 * random.gaussian();
    if (range < kMaxRange) range = std::max(0.05, range + noise);
    ranges.push_back(static_cast<float>(range));
  }
  return ranges;
}

}  // namespace usher::amcl
