#include "foundation/imaging/depth_image.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <string>

namespace usher::imaging {

namespace {
constexpr int kLeastPixels = 16;
constexpr int kMostPixels = 1024;
constexpr std::uint8_t kLeastValue = 2;  // thesis 4.8
}  // namespace

Status check(const Intrinsics& intrinsics) {
  const auto between = [](double value, double low, double high) {
    return std::isfinite(value) && value >= low && value <= high;
  };
  const auto refuse = [](const char* what, double found) {
    return Error{std::string(what) + ", got " + std::to_string(found)};
  };
  if (!between(intrinsics.width, kLeastPixels, kMostPixels))
    return refuse("width of the depth image must be in [16, 1024]", intrinsics.width);
  if (!between(intrinsics.height, kLeastPixels, kMostPixels))
    return refuse("height of the depth image must be in [16, 1024]", intrinsics.height);
  if (!between(intrinsics.fx, 0.25 * intrinsics.width, 10.0 * intrinsics.width))
    return refuse("fx must be 0.25 to 10 image widths", intrinsics.fx);
  if (!between(intrinsics.fy, 0.25 * intrinsics.height, 10.0 * intrinsics.height))
    return refuse("fy must be 0.25 to 10 image heights", intrinsics.fy);
  if (!between(intrinsics.cx, 0.0, intrinsics.width))
    return refuse("cx must lie in the image", intrinsics.cx);
  if (!between(intrinsics.cy, 0.0, intrinsics.height))
    return refuse("cy must lie in the image", intrinsics.cy);
  return {};
}

void widen(std::span<const std::uint8_t> image, double far, std::span<std::uint16_t> millimeters) {
  assert(image.size() == millimeters.size());
  std::array<std::uint16_t, 256> table{};
  for (std::size_t v = kLeastValue; v < 255; ++v) {  // 255 is "nothing there" as well
    table[v] = static_cast<std::uint16_t>(std::lround(static_cast<double>(v) * far * 1e3 / 255.0));
  }
  for (std::size_t i = 0; i < image.size(); ++i) millimeters[i] = table[image[i]];
}

}  // namespace usher::imaging
