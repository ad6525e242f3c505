#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/imaging/depth_image.hpp"
#include "foundation/result/result.hpp"

namespace usher::people_study {

/// A frame of a depth camera in which the pixels of one person are marked.
struct MaskedFrame {
  std::string name;
  imaging::Intrinsics camera;
  std::vector<std::uint16_t> millimeters;  ///< 0: nothing
  std::vector<std::uint8_t> mask;          ///< 1: the person

  imaging::DepthImage image() const { return {camera.width, camera.height, millimeters}; }
};

/// All `N_depth.png` (16 bits, millimetres) of a folder with their `N_mask.jpg` (128 and more: the
/// person) and `N_camera.xml` (intrinsics as OpenCV writes them), by name. Errors name the file.
Result<std::vector<MaskedFrame>> read_masked_frames(const std::string& folder);

}  // namespace usher::people_study
