#include "drivers/kinect/shell/camera_publisher.hpp"

#include "wire/images.hpp"

namespace usher::kinect {

CameraPublisher::CameraPublisher(runtime::Host& host)
    : depth_(host.output(topics::kKinectDepth)),
      color_(host.output(topics::kKinectColor)),
      info_(host.output(topics::kKinectInfo)) {}

void CameraPublisher::publish_info(runtime::Time stamp, const imaging::Intrinsics& intrinsics) {
  info_.publish(wire::to_message(stamp, kFrame, intrinsics));
}

void CameraPublisher::publish(runtime::Time stamp, const Frame& frame) {
  wire::to_message(stamp, kFrame, frame.view(), message_);
  depth_.publish(message_);
}

void CameraPublisher::publish(runtime::Time stamp, const ColorFrame& frame) {
  wire::to_color_message(stamp, kFrame, frame.width, frame.rgb, message_);
  color_.publish(message_);
}

}  // namespace usher::kinect
