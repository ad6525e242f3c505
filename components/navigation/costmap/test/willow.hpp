#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/grid/map_file.hpp"
#include "foundation/random/random.hpp"

// The Willow Garage building and scans of it, as the published figures of other costmaps use them.
namespace usher::costmap {

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A trinary map of 0.05 m cells; empty when the file is no picture.
inline grid::OccupancyGrid willow_map(const std::string& path, double origin_x, double origin_y) {
  const auto image = grid::decode_map_image(bytes_of(path), path);
  if (!image) return {};
  grid::MapDescription description;
  description.resolution = 0.05;
  description.origin = {origin_x, origin_y, 0.0};
  description.occupied_threshold = 0.65;
  description.free_threshold = 0.196;
  return grid::to_occupancy(*image, description);
}

/// 541 beams over 270 deg: steps of 0.0125 m to the first occupied cell, 30 m without one, 0.01 m
/// of Gaussian noise on echoes (one draw per beam). The map's origin is (0, 0).
inline std::vector<float> willow_scan(const grid::OccupancyGrid& map, const geometry::Pose2& sensor,
                                      std::uint64_t seed) {
  constexpr int kBeams = 541;
  constexpr double kStep = 0.0125;
  constexpr double kNoEcho = 30.0;
  Random random(seed);
  std::vector<float> ranges(kBeams);
  for (int beam = 0; beam < kBeams; ++beam) {
    const double angle = sensor.yaw + geometry::radians(-135.0 + 0.5 * beam);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    double range = kNoEcho;
    for (int step = 0; step * kStep < kNoEcho; ++step) {
      // In cells; the map begins at the origin, so truncation is floor.
      const double x = (sensor.x + step * kStep * c) * 20.0;
      const double y = (sensor.y + step * kStep * s) * 20.0;
      if (!(x >= 0.0 && y >= 0.0 && x < map.width() && y < map.height())) break;
      if (map.row(static_cast<int>(y))[static_cast<int>(x)] != grid::kOccupied) continue;
      range = step * kStep;
      break;
    }
    const double noise = random.gaussian();
    if (range < kNoEcho) range = std::max(0.05, range + 0.01 * noise);
    ranges[static_cast<std::size_t>(beam)] = static_cast<float>(range);
  }
  return ranges;
}

}  // namespace usher::costmap
