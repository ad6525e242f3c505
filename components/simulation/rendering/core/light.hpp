#pragma once

#include <array>
#include <cstdint>

#include "foundation/geometry/pose2.hpp"
#include "foundation/random/random.hpp"

namespace usher::rendering {

/// Factors of linear red, green and blue light.
using Gains = std::array<double, 3>;

/// The light of a building: brighter by a window than in a corridor, warmer below one lamp than the
/// next, changing smoothly over some metres.
class Lighting {
 public:
  explicit Lighting(std::uint64_t seed) : seed_(stream_seed(seed, "lighting")) {}
  /// At a place [m]; 1 is the usual brightness.
  Gains at(const geometry::Point2& place) const;

 private:
  double field(std::uint64_t which, const geometry::Point2& place) const;
  std::uint64_t seed_;
};

/// Exposure and white balance of one color camera: those of the device, those that drift while it
/// adapts, and an exposure that makes up for most of the light where the camera is.
class ColorCamera {
 public:
  explicit ColorCamera(std::uint64_t seed);
  /// Some time passes, at least 0 s.
  void advance(double seconds);
  /// What it makes of something at a place, from where it is.
  Gains gains(const Lighting& lighting, const geometry::Point2& place,
              const geometry::Point2& camera) const;

 private:
  /// Wanders about 0.
  struct Drift {
    double sigma, lasts;  ///< lasts: [s]
    double value = 0.0;
  };
  Random random_;
  std::array<double, 3> device_{};  ///< of log exposure, red and blue
  std::array<Drift, 3> drifts_;     ///< likewise
};

}  // namespace usher::rendering
