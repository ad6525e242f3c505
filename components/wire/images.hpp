#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "foundation/imaging/color_image.hpp"
#include "foundation/imaging/depth_image.hpp"
#include "foundation/result/result.hpp"
#include "ros2.h"
#include "runtime/api/time.hpp"

namespace usher::wire {

/// A 16UC1 image in millimetres.
void to_message(runtime::Time stamp, std::string_view frame, const imaging::DepthImage& image,
                sensor_msgs::msg::Image& message);
/// An rgb8 image of `width` columns.
void to_color_message(runtime::Time stamp, std::string_view frame, int width,
                      std::span<const std::uint8_t> rgb, sensor_msgs::msg::Image& message);

/// A color image: rgb8, bgr8 or mono8, rows without padding. The result looks at the message where
/// that is rgb8, else at `rgb`, which the values are copied to. Refused with the reason: another
/// encoding, rows that do not fit.
Result<imaging::ColorImage> color_image(const sensor_msgs::msg::Image& message,
                                        std::vector<std::uint8_t>& rgb);

/// A depth image of the given size: 16UC1 or mono16 in millimetres, or 8UC1 or mono8 where 255 is
/// `far` m (thesis 4.9). The values are copied to `millimeters`, which the result looks at. Refused
/// with the reason: another encoding, size or byte order, rows that do not fit.
Result<imaging::DepthImage> depth_image(const sensor_msgs::msg::Image& message, double far,
                                        std::vector<std::uint16_t>& millimeters);

sensor_msgs::msg::CameraInfo to_message(runtime::Time stamp, std::string_view frame,
                                        const imaging::Intrinsics& intrinsics);
/// Of a rectified image: K where the distortion is zero, else P, which a driver that rectifies has
/// beside the lens' own K and distortion (ROS image_rect). Refused: a distortion without such a P.
Result<imaging::Intrinsics> from_message(const sensor_msgs::msg::CameraInfo& message);

}  // namespace usher::wire
