#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace usher::imaging {

/// A color in CIE L*a*b* (white: D65).
struct LabColor {
  double lightness = 0.0;  ///< {0..100}
  double a = 0.0;          ///< green to red
  double b = 0.0;          ///< blue to yellow
};

/// Linear light {0..1} of one byte of sRGB, and back (clipped) [iec61966srgb].
double to_linear(std::uint8_t srgb);
std::uint8_t to_srgb(double linear);
/// Of linear red, green and blue {0..1} [cie2004colorimetry].
LabColor to_lab(const std::array<double, 3>& linear);

/// The color of some clothes as one camera shows it: the light and the camera's white balance are
/// in it.
struct ClothesColor {
  static constexpr int kImages = 6;
  LabColor color;
  int images = 0;  ///< {0..kImages} that it is the mean of; 0: not known

  bool known() const { return images > 0; }
};

struct Appearance {
  ClothesColor upper, legs;

  bool known() const { return upper.known() || legs.known(); }
};

/// Takes one more image into a mean of the last ones. A part that it does not show stays as it is.
void learn(Appearance& appearance, const Appearance& seen);
/// Takes this share {0..1} of what is seen; a part that was not known becomes what is seen.
void blend(Appearance& appearance, const Appearance& seen, double share);

/// How somebody looks to each of several cameras.
inline constexpr std::size_t kCameras = 2;
using Appearances = std::array<Appearance, kCameras>;

/// How unlike two sightings look {0..}: the sum over the parts that both show of the squared
/// differences, in units of what light, exposure and white balance do to one person (so a person's
/// own are below kAlike in 9 of 10 cases, see tests/simulation/people_chain_test.cpp). Of the
/// cameras that saw both the one that differs most counts; when none did, one camera's colors
/// against another's, which white balance makes less certain. None where nothing can be compared.
std::optional<double> unlikeness(const Appearance& one, const Appearance& other);
std::optional<double> unlikeness(const Appearances& one, const Appearances& other);

inline constexpr double kAlike = 5.0;     ///< below: may well be the same person
inline constexpr double kAnother = 16.0;  ///< above: is another one

}  // namespace usher::imaging
