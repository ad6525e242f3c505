#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "foundation/imaging/color_image.hpp"
#include "foundation/imaging/depth_image.hpp"
#include "foundation/random/random.hpp"
#include "simulation/rendering/core/texture.hpp"

namespace usher::face_detector {

/// A pair of images of a wall of uneven brightness, with drawn faces before it.
class DrawnScene {
 public:
  static constexpr int kWidth = 640, kHeight = 480;
  static constexpr std::size_t kPixels = 307'200;

  explicit DrawnScene(std::uint16_t wall = 3000) : rgb_(3 * kPixels), millimeters_(kPixels, wall) {
    Random random(5);
    for (int row = 0; row < kHeight; ++row) {
      for (int column = 0; column < kWidth; ++column) {
        const double value = 150 + 30 * std::sin(0.013 * column) + 20 * std::cos(0.02 * row) +
                             3.0 * random.gaussian();
        for (int k = 0; k < 3; ++k) rgb_[at(row, column, k)] = static_cast<std::uint8_t>(value);
      }
    }
  }

  /// A face around a pixel which the cascades put a box of about this size around, at a depth [mm].
  void add_face(int column, int row, double size, std::uint16_t depth, std::uint64_t number = 1) {
    const rendering::Texture face = rendering::drawn_face(number);
    const double half = 0.5 * size / (1.2 * 0.74);
    for (int r = static_cast<int>(row - half); r < static_cast<int>(row + half); ++r) {
      for (int c = static_cast<int>(column - half); c < static_cast<int>(column + half); ++c) {
        if (r < 0 || c < 0 || r >= kHeight || c >= kWidth) continue;
        const auto u = static_cast<float>((c - column) / half);
        const auto v = static_cast<float>((r - row) / half);
        if (std::hypot(u, 0.9F * v) > 0.95F) continue;
        const auto color = face.at(u, v, static_cast<float>(1.0 / half));
        for (int k = 0; k < 3; ++k)
          rgb_[at(r, c, k)] = static_cast<std::uint8_t>(color[static_cast<std::size_t>(k)]);
        millimeters_[at(r, c, 0) / 3] = depth;
      }
    }
  }

  imaging::ColorImage color() const { return {kWidth, kHeight, rgb_}; }
  imaging::DepthImage depth() const { return {kWidth, kHeight, millimeters_}; }
  std::vector<std::uint8_t>& rgb() { return rgb_; }
  std::vector<std::uint16_t>& millimeters() { return millimeters_; }

 private:
  static std::size_t at(int row, int column, int k) {
    return 3 * (static_cast<std::size_t>(row) * kWidth + static_cast<std::size_t>(column)) +
           static_cast<std::size_t>(k);
  }
  std::vector<std::uint8_t> rgb_;
  std::vector<std::uint16_t> millimeters_;
};

}  // namespace usher::face_detector
