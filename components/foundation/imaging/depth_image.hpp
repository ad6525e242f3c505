#pragma once

#include <cstdint>
#include <span>

#include "foundation/result/result.hpp"

/// Depth images and the cameras that take them, as drivers, the depth pipeline and people detection
/// know them.
namespace usher::imaging {

/// A pinhole camera without distortion; pixel (column, row) looks along
/// ((column - cx) / fx, (row - cy) / fy, 1): right, down, forward.
struct Intrinsics {
  int width = 512;    ///< [pixels] {16..1024}
  int height = 424;   ///< [pixels] {16..1024}
  double fx = 365.0;  ///< [pixels]
  double fy = 365.0;  ///< [pixels]
  double cx = 255.5;  ///< [pixels]
  double cy = 211.5;  ///< [pixels]
  bool operator==(const Intrinsics&) const = default;
};

/// The error names the first value that cannot be.
Status check(const Intrinsics& intrinsics);

/// A depth image: distance of the surface from the focal plane (not from the focal point), row by
/// row from the top.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::span<const std::uint16_t> millimeters;  ///< width * height values, 0: nothing measured
};

/// Turns an 8-bit image (thesis 4.9: 255 = `far` m, values below 2 invalid) into millimetres.
/// `millimeters` has the size of `image`.
void widen(std::span<const std::uint8_t> image, double far, std::span<std::uint16_t> millimeters);

}  // namespace usher::imaging
