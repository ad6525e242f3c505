#pragma once

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::kinect {

/// The driver over the simulated cameras, Kinect and rear camera: they deliver what a driver would.
class KinectSimComponent final : public runtime::Component {
 public:
  explicit KinectSimComponent(runtime::Host& host);

 private:
  using Image = sensor_msgs::msg::Image;
  using Info = sensor_msgs::msg::CameraInfo;

  /// From a simulated topic to the real one.
  template <class Message>
  struct Pass {
    runtime::Output<Message> output;
    runtime::Input<Message> input;
  };

  runtime::Host& host_;
  Pass<Image> depth_, color_, rear_depth_, rear_color_;
  Pass<Info> info_, rear_info_;
};

}  // namespace usher::kinect
