#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::rendering {

/// A square picture that is put on a surface, with smaller copies of itself: what is seen from afar
/// takes the mean of many of its pixels.
class Texture {
 public:
  using Color = std::array<float, 3>;  ///< red, green, blue {0..255}

  /// From side * side * 3 bytes, row by row from the top left. The error says what does not fit.
  static Result<Texture> make(int side, std::span<const std::uint8_t> rgb);

  /// The color at (u, v) in [-1, 1], right and down; outside, that of the edge. `pixel` is how much
  /// of u one pixel of the image covers.
  Color at(float u, float v, float pixel) const;

 private:
  struct Level {
    int side = 0;
    std::vector<float> rgb;
  };
  static Color sample(const Level& level, float u, float v);
  std::vector<Level> levels_;  // the finest first
};

/// On a head the picture of a face is so much higher than wide.
inline constexpr double kFaceAspect = 1.2;

/// A face, drawn: the same number gives the same face, others differ in skin, hair, eyes and mouth.
/// It fills [-1, 1]: temples at about 0.72, chin at 0.95, eyes at -0.12.
Texture drawn_face(std::uint64_t number, int side = 128);

}  // namespace usher::rendering
