#include "wire/images.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "wire/conversions.hpp"

namespace usher::wire {

namespace {

constexpr std::uint32_t kMostPixels = 4096;  // of a side

void fill(runtime::Time stamp, std::string_view frame, int width, int height,
          std::size_t bytes_per_pixel, const char* encoding, const void* data,
          sensor_msgs::msg::Image& message) {
  message.header(header(stamp, frame));
  message.width(static_cast<std::uint32_t>(width));
  message.height(static_cast<std::uint32_t>(height));
  message.encoding(encoding);
  message.is_bigendian(0);
  message.step(static_cast<std::uint32_t>(static_cast<std::size_t>(width) * bytes_per_pixel));
  message.data().resize(std::size_t{message.step()} * message.height());
  std::memcpy(message.data().data(), data, message.data().size());
}

}  // namespace

void to_message(runtime::Time stamp, std::string_view frame, const imaging::DepthImage& image,
                sensor_msgs::msg::Image& message) {
  fill(stamp, frame, image.width, image.height, 2, "16UC1", image.millimeters.data(), message);
}

void to_color_message(runtime::Time stamp, std::string_view frame, int width,
                      std::span<const std::uint8_t> rgb, sensor_msgs::msg::Image& message) {
  const auto height = static_cast<int>(rgb.size() / 3 / static_cast<std::size_t>(width));
  fill(stamp, frame, width, height, 3, "rgb8", rgb.data(), message);
}

Result<imaging::ColorImage> color_image(const sensor_msgs::msg::Image& message,
                                        std::vector<std::uint8_t>& rgb) {
  const bool gray = message.encoding() == "mono8";
  const bool swapped = message.encoding() == "bgr8";
  if (!gray && !swapped && message.encoding() != "rgb8")
    return Error{"a color image is rgb8, bgr8 or mono8, got '" + message.encoding() + "'"};
  const std::uint32_t width = message.width(), height = message.height();
  const std::uint64_t row = std::uint64_t{width} * (gray ? 1 : 3);
  if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels ||
      message.step() != row || message.data().size() != row * height) {
    return Error{"a color image of " + std::to_string(width) + " x " + std::to_string(height) +
                 " with rows of " + std::to_string(message.step()) + " bytes carries " +
                 std::to_string(message.data().size())};
  }
  const auto& data = message.data();
  const std::size_t pixels = std::size_t{width} * height;
  const int columns = static_cast<int>(width), rows = static_cast<int>(height);
  if (!gray && !swapped) return imaging::ColorImage{columns, rows, data};
  rgb.resize(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t k = 0; k < 3; ++k) rgb[3 * i + k] = gray ? data[i] : data[3 * i + 2 - k];
  }
  return imaging::ColorImage{columns, rows, rgb};
}

Result<imaging::DepthImage> depth_image(const sensor_msgs::msg::Image& message, double far,
                                        std::vector<std::uint16_t>& millimeters) {
  const bool wide = message.encoding() == "16UC1" || message.encoding() == "mono16";
  const bool narrow = message.encoding() == "8UC1" || message.encoding() == "mono8";
  if (!wide && !narrow)
    return Error{"a depth image is 16UC1 or 8UC1, got '" + message.encoding() + "'"};
  if (wide && message.is_bigendian() != 0) return Error{"a depth image is little-endian"};
  const std::uint32_t width = message.width(), height = message.height();
  const std::uint64_t row = std::uint64_t{width} * (wide ? 2 : 1);
  if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels ||
      message.step() != row || message.data().size() != row * height) {
    return Error{"a depth image of " + std::to_string(width) + " x " + std::to_string(height) +
                 " with rows of " + std::to_string(message.step()) + " bytes carries " +
                 std::to_string(message.data().size())};
  }
  millimeters.resize(std::size_t{width} * height);
  if (wide) {
    std::memcpy(millimeters.data(), message.data().data(), message.data().size());
  } else {
    imaging::widen(message.data(), far, millimeters);
  }
  return imaging::DepthImage{static_cast<int>(width), static_cast<int>(height), millimeters};
}

sensor_msgs::msg::CameraInfo to_message(runtime::Time stamp, std::string_view frame,
                                        const imaging::Intrinsics& intrinsics) {
  sensor_msgs::msg::CameraInfo message;
  message.header(header(stamp, frame));
  message.width(static_cast<std::uint32_t>(intrinsics.width));
  message.height(static_cast<std::uint32_t>(intrinsics.height));
  message.distortion_model("plumb_bob");
  message.d().assign(5, 0.0);
  const imaging::Intrinsics& i = intrinsics;
  message.k({i.fx, 0.0, i.cx, 0.0, i.fy, i.cy, 0.0, 0.0, 1.0});
  message.r({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  message.p({i.fx, 0.0, i.cx, 0.0, 0.0, i.fy, i.cy, 0.0, 0.0, 0.0, 1.0, 0.0});
  return message;
}

Result<imaging::Intrinsics> from_message(const sensor_msgs::msg::CameraInfo& message) {
  if (message.width() > kMostPixels || message.height() > kMostPixels)
    return Error{"a camera of " + std::to_string(message.width()) + " x " +
                 std::to_string(message.height()) + " pixels"};
  const int width = static_cast<int>(message.width()), height = static_cast<int>(message.height());
  const auto& k = message.k();
  imaging::Intrinsics intrinsics{width, height, k[0], k[4], k[2], k[5]};
  const auto& distortion = message.d();
  if (std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0.0; })) {
    const auto& p = message.p();
    const imaging::Intrinsics rectified{width, height, p[0], p[5], p[2], p[6]};
    if (!(p[0] > 0.0) || rectified == intrinsics)
      return Error{
          "the depth image must be rectified: its camera_info has a distortion that is not zero "
          "and no P of a rectified image"};
    intrinsics = rectified;
  }
  if (const auto status = imaging::check(intrinsics); !status) return Error{status.error()};
  return intrinsics;
}

}  // namespace usher::wire
