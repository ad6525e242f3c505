#pragma once

#include "drivers/gamepad/core/joystick.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::gamepad {

/// Publishes `joy` as ROS 2's joy node does: at each change, and at 20 Hz while a pad is there.
class GamepadComponent final : public runtime::Component {
 public:
  explicit GamepadComponent(runtime::Host& host);

 private:
  void publish();

  runtime::Host& host_;
  Joystick pad_;
  bool there_ = false;
  std::uint64_t& rejected_;
  runtime::Output<sensor_msgs::msg::Joy> joy_;
  runtime::Timer timer_;
};

}  // namespace usher::gamepad
