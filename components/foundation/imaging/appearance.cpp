#include "foundation/imaging/appearance.hpp"

#include <algorithm>
#include <cmath>

namespace usher::imaging {

namespace {

// Standard deviations between two sightings of the same clothes.
constexpr double kLightness = 10.0;
constexpr double kChromaticity = 4.0;
constexpr double kOfChroma = 0.12;        // and this share of the chroma: light scales it
constexpr double kMostOfAPart = 40.0;     // a part counts no more than that
constexpr double kBetweenCameras = 0.45;  // of the weight that the same camera's colors have

double part(const ClothesColor& one, const ClothesColor& other) {
  const double chroma =
      0.5 * (std::hypot(one.color.a, one.color.b) + std::hypot(other.color.a, other.color.b));
  const double spread = kChromaticity + kOfChroma * chroma;
  const double lighter = (one.color.lightness - other.color.lightness) / kLightness;
  const double redder = (one.color.a - other.color.a) / spread;
  const double yellower = (one.color.b - other.color.b) / spread;
  return std::min(kMostOfAPart, lighter * lighter + redder * redder + yellower * yellower);
}

void move(LabColor& color, const LabColor& to, double share) {
  color.lightness += share * (to.lightness - color.lightness);
  color.a += share * (to.a - color.a);
  color.b += share * (to.b - color.b);
}

void learn(ClothesColor& mean, const ClothesColor& seen) {
  if (!seen.known()) return;
  mean.images = std::min(mean.images + 1, ClothesColor::kImages);
  move(mean.color, seen.color, 1.0 / mean.images);
}

void blend(ClothesColor& mean, const ClothesColor& seen, double share) {
  if (!seen.known()) return;
  move(mean.color, seen.color, mean.known() ? share : 1.0);
  mean.images = std::max(mean.images, seen.images);
}

}  // namespace

double to_linear(std::uint8_t srgb) {
  const double value = srgb / 255.0;
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

std::uint8_t to_srgb(double linear) {
  const double light = std::clamp(linear, 0.0, 1.0);
  const double value =
      light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * value));
}

LabColor to_lab(const std::array<double, 3>& linear) {
  const auto [r, g, b] = linear;
  const auto bend = [](double share) {
    constexpr double kEdge = 216.0 / 24389.0;
    constexpr double kSlope = 24389.0 / 27.0;
    return share > kEdge ? std::cbrt(share) : (kSlope * share + 16.0) / 116.0;
  };
  // X, Y and Z over those of white.
  const double x = bend((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = bend(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = bend((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

void learn(Appearance& appearance, const Appearance& seen) {
  learn(appearance.upper, seen.upper);
  learn(appearance.legs, seen.legs);
}

void blend(Appearance& appearance, const Appearance& seen, double share) {
  blend(appearance.upper, seen.upper, share);
  blend(appearance.legs, seen.legs, share);
}

std::optional<double> unlikeness(const Appearance& one, const Appearance& other) {
  std::optional<double> sum;
  if (one.upper.known() && other.upper.known()) sum = part(one.upper, other.upper);
  if (one.legs.known() && other.legs.known()) sum = sum.value_or(0.0) + part(one.legs, other.legs);
  return sum;
}

std::optional<double> unlikeness(const Appearances& one, const Appearances& other) {
  std::optional<double> most;
  for (std::size_t camera = 0; camera < kCameras; ++camera)
    most = std::max(most, unlikeness(one[camera], other[camera]));
  if (most) return most;
  for (std::size_t camera = 0; camera < kCameras; ++camera)
    most = std::max(most, unlikeness(one[camera], other[kCameras - 1 - camera]));
  if (most) *most *= kBetweenCameras;
  return most;
}

}  // namespace usher::imaging
