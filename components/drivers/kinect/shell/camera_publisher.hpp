#pragma once

#include "drivers/kinect/core/recording.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::kinect {

/// The Kinect's topics.
class CameraPublisher {
 public:
  explicit CameraPublisher(runtime::Host& host);

  void publish_info(runtime::Time stamp, const imaging::Intrinsics& intrinsics);
  void publish(runtime::Time stamp, const Frame& frame);
  /// Of the same moment, pixel by pixel what the depths lie on.
  void publish(runtime::Time stamp, const ColorFrame& frame);

 private:
  sensor_msgs::msg::Image message_;
  runtime::Output<sensor_msgs::msg::Image> depth_, color_;
  runtime::Output<sensor_msgs::msg::CameraInfo> info_;
};

inline constexpr const char* kFrame = "kinect_depth_optical";

}  // namespace usher::kinect
