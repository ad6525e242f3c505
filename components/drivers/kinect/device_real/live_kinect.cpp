#include "drivers/kinect/device_real/live_kinect.hpp"

#include <libfreenect_sync.h>

#include <algorithm>

#include "drivers/kinect/core/camera_model.hpp"

namespace usher::kinect {

namespace {
constexpr int kWidth = 640, kHeight = 480;
constexpr std::size_t kPixels = std::size_t{640} * 480;
}  // namespace

LiveKinect::~LiveKinect() { freenect_sync_stop(); }

Result<Stamps> LiveKinect::read(Frame& depth, ColorFrame& color) {
  void* depths = nullptr;
  void* colors = nullptr;
  Stamps stamps;
  const auto format = values_ == Values::kRaw11 ? FREENECT_DEPTH_11BIT : FREENECT_DEPTH_REGISTERED;
  if (freenect_sync_get_depth(&depths, &stamps.depth, 0, format) != 0 ||
      freenect_sync_get_video(&colors, &stamps.color, 0, FREENECT_VIDEO_RGB) != 0)
    return Error{"no Kinect v1 at the USB, or it may not be opened (udev rules of libfreenect)"};
  const auto* values = static_cast<const std::uint16_t*>(depths);
  depth.width = kWidth;
  depth.height = kHeight;
  depth.millimeters.assign(values, values + kPixels);
  if (values_ == Values::kRaw11)
    std::transform(depth.millimeters.begin(), depth.millimeters.end(), depth.millimeters.begin(),
                   millimeters_of_raw);
  const auto* rgb = static_cast<const std::uint8_t*>(colors);
  color.width = kWidth;
  color.height = kHeight;
  color.rgb.assign(rgb, rgb + 3 * kPixels);
  return stamps;
}

}  // namespace usher::kinect
