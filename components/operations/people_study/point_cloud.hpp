#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::people_study {

/// The depth of an organized point cloud file (PCD 0.7, binary_compressed, float x y z ...), row by
/// row in millimetres; 0: no point.
struct PointCloudDepth {
  int width = 0, height = 0;
  std::vector<std::uint16_t> millimeters;
};
/// The error says what was expected.
Result<PointCloudDepth> parse_point_cloud(std::span<const std::uint8_t> bytes);
Result<PointCloudDepth> read_point_cloud(const std::string& path);

}  // namespace usher::people_study
