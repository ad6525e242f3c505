#pragma once

#include <cstdint>
#include <span>

namespace usher::imaging {

/// A color image: red, green, blue, one byte each, row by row from the top left.
struct ColorImage {
  int width = 0;
  int height = 0;
  std::span<const std::uint8_t> rgb;  ///< 3 * width * height values
};

}  // namespace usher::imaging
