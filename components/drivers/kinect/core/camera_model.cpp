#include "drivers/kinect/core/camera_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace usher::kinect {

namespace {

constexpr int kNoRaw = 2047;
constexpr double kFarthest = 10000.0;  // [mm]
constexpr double kMostDistortion = 10.0;

}  // namespace

imaging::Intrinsics kinect_v1() { return {640, 480, 575.8, 575.8, 319.5, 239.5}; }
imaging::Intrinsics kinect_v1_registered() { return {640, 480, 525.0, 525.0, 319.5, 239.5}; }
imaging::Intrinsics kinect_v2() { return {512, 424, 365.46, 365.46, 254.88, 205.40}; }

std::uint16_t millimeters_of_raw(std::uint16_t raw) {
  // Distance between emitter and camera and of the reference plane [cm], pixel at that plane [cm],
  // and the shift of the disparity.
  constexpr double kEmitter = 7.5, kReference = 120.0, kPixel = 0.1042, kShift = 200.0;
  if (raw >= kNoRaw) return 0;
  const double moved = ((raw - 4.0 * kShift) / 4.0 - 0.375) * kPixel;
  const double millimeters = 10.0 * (moved * kReference / (kEmitter - moved) + kReference);
  if (!(millimeters > 0.0 && millimeters <= kFarthest)) return 0;
  return static_cast<std::uint16_t>(std::lround(millimeters));
}

Result<Rectifier> Rectifier::make(const imaging::Intrinsics& intrinsics,
                                  const Distortion& distortion, bool mirrored) {
  if (const auto status = imaging::check(intrinsics); !status) return Error{status.error()};
  for (std::size_t i = 0; i < distortion.size(); ++i) {
    if (!(std::abs(distortion[i]) <= kMostDistortion)) {
      return Error{"distortion value " + std::to_string(i) + " must be in [-10, 10], got " +
                   std::to_string(distortion[i])};
    }
  }
  Rectifier rectifier(intrinsics.width, intrinsics.height);
  const auto& [k1, k2, p1, p2, k3] = distortion;
  for (int row = 0; row < intrinsics.height; ++row) {
    for (int column = 0; column < intrinsics.width; ++column) {
      const double x = (column - intrinsics.cx) / intrinsics.fx;
      const double y = (row - intrinsics.cy) / intrinsics.fy;
      const double r2 = x * x + y * y;
      const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
      const double u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
      const double v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
      const double from_column = std::round(u * intrinsics.fx + intrinsics.cx);
      const double from_row = std::round(v * intrinsics.fy + intrinsics.cy);
      if (from_column < 0.0 || from_column >= intrinsics.width || from_row < 0.0 ||
          from_row >= intrinsics.height) {
        rectifier.source_.push_back(-1);
        continue;
      }
      const int at = static_cast<int>(from_column);
      const int taken = mirrored ? intrinsics.width - 1 - at : at;
      rectifier.source_.push_back(static_cast<int>(from_row) * intrinsics.width + taken);
    }
  }
  return rectifier;
}

Status Rectifier::check_size(int width, int height, std::size_t pixels) const {
  if (width == width_ && height == height_ && pixels == source_.size()) return {};
  return Error{"expected an image of " + std::to_string(width_) + " x " + std::to_string(height_) +
               ", got " + std::to_string(width) + " x " + std::to_string(height)};
}

Status Rectifier::rectify(const Frame& raw, Frame& rectified) const {
  if (auto fits = check_size(raw.width, raw.height, raw.millimeters.size()); !fits) return fits;
  rectified.width = width_;
  rectified.height = height_;
  rectified.millimeters.resize(source_.size());
  for (std::size_t i = 0; i < source_.size(); ++i) {
    rectified.millimeters[i] =
        source_[i] < 0 ? std::uint16_t{0} : raw.millimeters[static_cast<std::size_t>(source_[i])];
  }
  return {};
}

Status Rectifier::rectify(const ColorFrame& raw, ColorFrame& rectified) const {
  if (auto fits = check_size(raw.width, raw.height, raw.rgb.size() / 3); !fits) return fits;
  rectified.width = width_;
  rectified.height = height_;
  rectified.rgb.assign(3 * source_.size(), 0);
  for (std::size_t i = 0; i < source_.size(); ++i) {
    if (source_[i] < 0) continue;
    std::copy_n(&raw.rgb[3 * static_cast<std::size_t>(source_[i])], 3, &rectified.rgb[3 * i]);
  }
  return {};
}

}  // namespace usher::kinect
