#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "drivers/kinect/core/device.hpp"

namespace usher::kinect {

/// What the two devices measure with, by default; a calibration of the single device is better.
imaging::Intrinsics kinect_v1();  ///< depth camera, 640 x 480
/// The same laid on the color image, as the device's own registration delivers it.
imaging::Intrinsics kinect_v1_registered();
imaging::Intrinsics kinect_v2();  ///< depth camera, 512 x 424

/// Radial and tangential distortion: k1, k2, p1, p2, k3 of the usual (Brown) model.
using Distortion = std::array<double, 5>;
inline constexpr Distortion kKinectV2Distortion{0.0905, -0.2682, 0.0, 0.0, 0.0951};

/// Millimetres of what a Kinect v1 delivers as 11 bits: z = E f / (disparity), in the form that its
/// factory constants have. 2047 and what is beyond 10 m give 0.
std::uint16_t millimeters_of_raw(std::uint16_t raw);

/// Takes a lens' distortion out of images by looking up the nearest pixel: depths must not be
/// mixed. Mirrors when asked (a Kinect v2 delivers mirrored images). No allocation after
/// construction besides the result.
class Rectifier {
 public:
  /// The error says which value is not finite, or too large to be a lens.
  static Result<Rectifier> make(const imaging::Intrinsics& intrinsics, const Distortion& distortion,
                                bool mirrored);

  /// An image of another size than the intrinsics' is refused.
  Status rectify(const Frame& raw, Frame& rectified) const;
  /// The same for the colors of its pixels; black where nothing is known.
  Status rectify(const ColorFrame& raw, ColorFrame& rectified) const;

 private:
  Rectifier(int width, int height) : width_(width), height_(height) {}
  Status check_size(int width, int height, std::size_t pixels) const;
  int width_, height_;
  std::vector<std::int32_t> source_;  // index of the pixel to take; -1: outside
};

}  // namespace usher::kinect
