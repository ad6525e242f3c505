#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "foundation/imaging/color_image.hpp"
#include "foundation/imaging/depth_image.hpp"

namespace usher::kinect {

/// One depth image, however it was obtained: rectified, as a camera without distortion sees it.
struct Frame {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> millimeters;  ///< row by row from the top left; 0: nothing measured

  imaging::DepthImage view() const { return {width, height, millimeters}; }
};

/// The color image of the same moment, pixel by pixel.
struct ColorFrame {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< red, green, blue, row by row from the top left

  imaging::ColorImage view() const { return {width, height, rgb}; }
};

}  // namespace usher::kinect
