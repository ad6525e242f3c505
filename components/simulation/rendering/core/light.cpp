#include "simulation/rendering/core/light.hpp"

#include <cmath>

namespace usher::rendering {

namespace {

using geometry::Point2;

constexpr double kPatch = 4.0;        // [m] over which the light changes
constexpr double kBrightness = 0.5;   // standard deviation of its logarithm, at the corners
constexpr double kWarmth = 0.06;      // of red over green and green over blue, likewise
constexpr double kAdapts = 0.6;       // share of the brightness that the exposure makes up for
constexpr double kDevice = 0.10;      // of a camera's log exposure
constexpr double kDeviceTint = 0.04;  // of its white balance
constexpr double kDrift = 0.10, kTintDrift = 0.03;
constexpr double kDriftLasts = 8.0, kTintLasts = 20.0;  // [s]

}  // namespace

/// Smooth noise: values drawn for the corners of squares, blended in between.
double Lighting::field(std::uint64_t which, const Point2& place) const {
  const auto corner = [&](double x, double y) {
    const auto number = [](double value) {
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    };
    Random mixed(seed_ ^ which);
    Random of_x(mixed.next() ^ number(x));
    return Random(of_x.next() ^ number(y)).gaussian();
  };
  const double x = place.x() / kPatch, y = place.y() / kPatch;
  const double left = std::floor(x), low = std::floor(y);
  const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
  const double u = smooth(x - left), v = smooth(y - low);
  return (1.0 - v) * ((1.0 - u) * corner(left, low) + u * corner(left + 1.0, low)) +
         v * ((1.0 - u) * corner(left, low + 1.0) + u * corner(left + 1.0, low + 1.0));
}

Gains Lighting::at(const Point2& place) const {
  if (!place.allFinite()) return {1.0, 1.0, 1.0};
  const double bright = kBrightness * field(0, place);
  const double warm = kWarmth * field(1, place);
  return {std::exp(bright + warm), std::exp(bright), std::exp(bright - warm)};
}

ColorCamera::ColorCamera(std::uint64_t seed)
    : random_(stream_seed(seed, "color camera")),
      drifts_{Drift{kDrift, kDriftLasts}, Drift{kTintDrift, kTintLasts},
              Drift{kTintDrift, kTintLasts}} {
  device_ = {random_.gaussian(0.0, kDevice), random_.gaussian(0.0, kDeviceTint),
             random_.gaussian(0.0, kDeviceTint)};
  for (Drift& drift : drifts_) drift.value = random_.gaussian(0.0, drift.sigma);
}

void ColorCamera::advance(double seconds) {
  for (Drift& drift : drifts_) {
    const double keeps = std::exp(-seconds / drift.lasts);
    drift.value =
        keeps * drift.value + random_.gaussian(0.0, drift.sigma * std::sqrt(1.0 - keeps * keeps));
  }
}

Gains ColorCamera::gains(const Lighting& lighting, const Point2& place,
                         const Point2& camera) const {
  Gains gains = lighting.at(place);
  const double exposure =
      std::exp(device_[0] + drifts_[0].value) / std::pow(lighting.at(camera)[1], kAdapts);
  gains[0] *= exposure * std::exp(device_[1] + drifts_[1].value);
  gains[1] *= exposure;
  gains[2] *= exposure * std::exp(device_[2] + drifts_[2].value);
  return gains;
}

}  // namespace usher::rendering
