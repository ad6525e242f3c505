#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "foundation/imaging/depth_image.hpp"

namespace usher::kinect {

/// One depth image, however it was obtained: rectified, as a camera without distortion sees it.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> millimeters;  ///< row by row from the top left; 0: nothing measured

  imaging::DepthImage view() const { return {width, height, millimeters}; }
};

}  // namespace usher::kinect
