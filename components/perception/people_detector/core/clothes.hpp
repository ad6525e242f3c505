#pragma once

#include <array>
#include <cstdint>

#include "foundation/imaging/appearance.hpp"
#include "foundation/imaging/color_image.hpp"
#include "foundation/imaging/depth_image.hpp"
#include "perception/people_detector/core/depth_detector.hpp"

namespace usher::people_detector {

/// The colors of somebody's clothes in one image: for the trunk and for the legs the median of red,
/// green and blue over those pixels whose depth lies on the body, in CIE L*a*b*. Pixels that are
/// over- or underexposed do not count. A part is not known when too little of it is seen, when most
/// of it is exposed wrongly, and below the hips of whoever is not upright. Of somebody whose head
/// leaves the image the parts are those of a person of usual height.
///
/// `depth` without floor and ceiling (0 = nothing), `color` of the same size, its pixels those of
/// `depth` (up to `kApart` before or after), else nothing is known. At most 0.1 ms for each person.
class Clothes {
 public:
  static constexpr double kApart = 0.045;  ///< [s] in which nobody moves out of the picture

  explicit Clothes(const imaging::Intrinsics& intrinsics) : intrinsics_(intrinsics) {}

  imaging::Appearance look(const imaging::DepthImage& depth, const imaging::ColorImage& color,
                           const View& view, const Sighting& person);

 private:
  /// A part of a body, from below the hips up.
  struct Part {
    double low, high;   ///< [m] above the floor
    double half_width;  ///< [m]
  };
  imaging::ClothesColor color_of(const imaging::DepthImage& depth, const imaging::ColorImage& color,
                                 const View& view, const Sighting& person, const Part& part);

  imaging::Intrinsics intrinsics_;
  std::array<std::array<std::uint16_t, 256>, 3> histograms_{};  ///< of red, green and blue
};

}  // namespace usher::people_detector
