#include "perception/people_detector/core/clothes.hpp"

#include <algorithm>
#include <cmath>

namespace usher::people_detector {

namespace {

// Shares of the height, without hands, neck and shoes.
constexpr double kUpperFrom = 0.58, kUpperTo = 0.78;
constexpr double kLegsFrom = 0.12, kLegsTo = 0.44;
constexpr double kUsualHeight = 1.7;  // [m]
constexpr double kUpright = 1.4;      // [m] who is lower sits, squats or is a child
constexpr double kHalfTrunk = 0.16;   // [m] without the arms
constexpr double kHalfLegs = 0.20;    // [m]
constexpr double kHalfDepth = 0.35;   // [m] before and behind the middle
constexpr double kNearest = 0.3;      // [m] of anything that is looked at
constexpr double kLeastArea = 0.015;  // [m^2] that must be seen of a part
constexpr int kLeastSamples = 12;     // likewise
constexpr int kSamples = 400;         // about so many pixels are looked at
constexpr std::uint8_t kOverexposed = 252;
constexpr std::uint8_t kUnderexposed = 4;

/// The value that half of `count` are below, between those of the histogram's middle.
double median(const std::array<std::uint16_t, 256>& histogram, int count) {
  double below = 0.0;
  for (std::size_t value = 0; value < histogram.size(); ++value) {
    const double here = histogram[value];
    if (here > 0.0 && below + here >= 0.5 * count)
      return static_cast<double>(value) - 0.5 + (0.5 * count - below) / here;
    below += here;
  }
  return 255.0;
}

double to_linear(double srgb) {
  const double low = std::clamp(std::floor(srgb), 0.0, 254.0);
  const auto byte = static_cast<std::uint8_t>(low);
  const double from = imaging::to_linear(byte);
  return from + (srgb - low) * (imaging::to_linear(static_cast<std::uint8_t>(byte + 1)) - from);
}

}  // namespace

imaging::Appearance Clothes::look(const imaging::DepthImage& depth,
                                  const imaging::ColorImage& color, const View& view,
                                  const Sighting& person) {
  const auto pixels =
      static_cast<std::size_t>(intrinsics_.width) * static_cast<std::size_t>(intrinsics_.height);
  const auto fits = [&](const auto& image) {
    return image.width == intrinsics_.width && image.height == intrinsics_.height;
  };
  if (!fits(depth) || !fits(color) || depth.millimeters.size() != pixels ||
      color.rgb.size() != 3 * pixels || !std::isfinite(person.forward) ||
      !std::isfinite(person.left) || !(person.height >= 0.0))
    return {};
  const double height = person.height > 0.0 ? person.height : kUsualHeight;
  imaging::Appearance appearance;
  appearance.upper =
      color_of(depth, color, view, person, {kUpperFrom * height, kUpperTo * height, kHalfTrunk});
  if (height >= kUpright)
    appearance.legs =
        color_of(depth, color, view, person, {kLegsFrom * height, kLegsTo * height, kHalfLegs});
  return appearance;
}

imaging::ClothesColor Clothes::color_of(const imaging::DepthImage& depth,
                                        const imaging::ColorImage& color, const View& view,
                                        const Sighting& person, const Part& part) {
  const double cos_down = std::cos(view.down), sin_down = std::sin(view.down);
  const double cos_roll = std::cos(view.roll), sin_roll = std::sin(view.roll);
  // The rectangle of the image that the part is in.
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const double up : {part.low, part.high}) {
    for (const double aside : {-part.half_width, part.half_width}) {
      for (const double ahead : {-kHalfDepth, 0.0}) {
        const double forward = person.forward + ahead, below = view.height - up;
        const double along = forward * cos_down + below * sin_down;
        if (along < kNearest) return {};
        const double x = -(person.left + aside) / along;
        const double y = (below * cos_down - forward * sin_down) / along;
        const double column = intrinsics_.cx + intrinsics_.fx * (x * cos_roll + y * sin_roll);
        const double row = intrinsics_.cy + intrinsics_.fy * (y * cos_roll - x * sin_roll);
        left = std::min(left, column), right = std::max(right, column);
        top = std::min(top, row), bottom = std::max(bottom, row);
      }
    }
  }
  const auto inside = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const int first = inside(left, intrinsics_.width), end = inside(right + 1.0, intrinsics_.width);
  const int upper = inside(top, intrinsics_.height),
            lower = inside(bottom + 1.0, intrinsics_.height);
  const double area = static_cast<double>(end - first) * (lower - upper);
  const int stride = std::max(1, static_cast<int>(std::sqrt(area / kSamples)));

  for (auto& histogram : histograms_) histogram.fill(0);
  int count = 0, wrong = 0;
  double seen = 0.0;  // [m^2]
  for (int row = upper; row < lower; row += stride) {
    const double v = (row - intrinsics_.cy) / intrinsics_.fy;
    for (int column = first; column < end; column += stride) {
      const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(intrinsics_.width) +
                     static_cast<std::size_t>(column);
      const double along = 1e-3 * depth.millimeters[i];
      if (along <= 0.0) continue;
      const double u = (column - intrinsics_.cx) / intrinsics_.fx;
      const double x = u * cos_roll - v * sin_roll, y = u * sin_roll + v * cos_roll;
      const double forward = along * (cos_down - y * sin_down);
      const double up = view.height - along * (sin_down + y * cos_down);
      if (std::abs(forward - person.forward) > kHalfDepth ||
          std::abs(-x * along - person.left) > part.half_width || up < part.low || up > part.high)
        continue;
      const std::uint8_t* rgb = color.rgb.data() + 3 * i;
      const auto [least, most] = std::minmax({rgb[0], rgb[1], rgb[2]});
      if (most >= kOverexposed || most <= kUnderexposed) {
        ++wrong;
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) ++histograms_[k][rgb[k]];
      seen += along * along;
      ++count;
    }
  }
  seen *= stride * stride / (intrinsics_.fx * intrinsics_.fy);
  if (count < kLeastSamples || seen < kLeastArea || wrong > count) return {};
  std::array<double, 3> linear{};
  for (std::size_t k = 0; k < 3; ++k) linear[k] = to_linear(median(histograms_[k], count));
  return {imaging::to_lab(linear), 1};
}

}  // namespace usher::people_detector
