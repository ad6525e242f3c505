#pragma once

#include "drivers/kinect/core/device.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::kinect {

/// The Kinect's topics.
class CameraPublisher {
 public:
  explicit CameraPublisher(runtime::Host& host);

  void publish_info(runtime::Time stamp, const imaging::Intrinsics& intrinsics);
  void publish(runtime::Time stamp, const Frame& frame);

 private:
  sensor_msgs::msg::Image message_;
  runtime::Output<sensor_msgs::msg::Image> depth_;
  runtime::Output<sensor_msgs::msg::CameraInfo> info_;
};

inline constexpr const char* kFrame = "kinect_depth_optical";

}  // namespace usher::kinect
