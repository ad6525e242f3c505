#include "simulation/rendering/core/texture.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace usher::rendering {

namespace {
constexpr int kMostSide = 1024;
constexpr int kLeastSide = 2;

std::size_t index(int side, int row, int column, int k) {
  const auto pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(side) +
                     static_cast<std::size_t>(column);
  return 3 * pixel + static_cast<std::size_t>(k);
}

}  // namespace

Result<Texture> Texture::make(int side, std::span<const std::uint8_t> rgb) {
  if (side < kLeastSide || side > kMostSide ||
      rgb.size() != 3 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side)) {
    return Error{"a texture of " + std::to_string(side) + " pixels (2 to 1024) carries " +
                 std::to_string(rgb.size()) + " bytes"};
  }
  Texture texture;
  texture.levels_.push_back({side, {rgb.begin(), rgb.end()}});
  while (texture.levels_.back().side / 2 >= kLeastSide) {
    const Level& fine = texture.levels_.back();
    Level coarse{fine.side / 2, {}};
    for (int row = 0; row < coarse.side; ++row) {
      for (int column = 0; column < coarse.side; ++column) {
        for (int k = 0; k < 3; ++k) {
          const auto value = [&](int r, int c) { return fine.rgb[index(fine.side, r, c, k)]; };
          const int r = 2 * row, c = 2 * column;
          coarse.rgb.push_back(
              0.25F * (value(r, c) + value(r, c + 1) + value(r + 1, c) + value(r + 1, c + 1)));
        }
      }
    }
    texture.levels_.push_back(std::move(coarse));
  }
  return texture;
}

/// Bilinear.
Texture::Color Texture::sample(const Level& level, float u, float v) {
  const auto last = static_cast<float>(level.side - 1);
  const float x = std::clamp(0.5F * (u + 1.0F) * static_cast<float>(level.side) - 0.5F, 0.0F, last);
  const float y = std::clamp(0.5F * (v + 1.0F) * static_cast<float>(level.side) - 0.5F, 0.0F, last);
  const int column = std::min(static_cast<int>(x), level.side - 2);
  const int row = std::min(static_cast<int>(y), level.side - 2);
  const float right = x - static_cast<float>(column), down = y - static_cast<float>(row);
  Color color{};
  for (int k = 0; k < 3; ++k) {
    const auto value = [&](int r, int c) { return level.rgb[index(level.side, r, c, k)]; };
    const float above = value(row, column) + right * (value(row, column + 1) - value(row, column));
    const float below =
        value(row + 1, column) + right * (value(row + 1, column + 1) - value(row + 1, column));
    color[static_cast<std::size_t>(k)] = above + down * (below - above);
  }
  return color;
}

Texture::Color Texture::at(float u, float v, float pixel) const {
  // The level on which one pixel of the image covers about one of the texture.
  float covered = 0.5F * pixel * static_cast<float>(levels_.front().side);
  std::size_t level = 0;
  for (; covered > 1.4F && level + 1 < levels_.size(); covered *= 0.5F) ++level;
  return sample(levels_[level], u, v);
}

}  // namespace usher::rendering
