#pragma once

#include "drivers/gamepad/core/joystick.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::gamepad {

/// Publishes `joy` as ROS 2's joy node does: at each change, and at 20 Hz while a pad is there. A
/// held button is repeated only for so long when the pad tells nothing.
class GamepadComponent final : public runtime::Component {
 public:
  explicit GamepadComponent(runtime::Host& host);

 private:
  void received(std::span<const std::uint8_t> bytes);
  void repeat();
  void publish();

  runtime::Host& host_;
  const runtime::Duration hold_timeout_;
  Joystick pad_;
  bool there_ = false;
  runtime::Time heard_at_{};  ///< the pad, last
  std::uint64_t& rejected_;
  std::uint64_t& let_go_;
  runtime::Output<sensor_msgs::msg::Joy> joy_;
  runtime::Timer timer_;
};

}  // namespace usher::gamepad
