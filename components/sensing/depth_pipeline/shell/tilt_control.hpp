#pragma once

#include <optional>

#include "foundation/kinematics/tilt_servo.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::depth_pipeline {

/// Keeps the Kinect's tilt where the supervisor asks for it: low to navigate, high to see faces; an
/// operator's request holds it elsewhere for two seconds.
class TiltControl {
 public:
  explicit TiltControl(runtime::Host& host);

  const kinematics::TiltServo& servo() const { return servo_; }
  /// [rad] Where the servo shall be for what the robot does, whoever holds it elsewhere.
  double wanted() const { return wanted_; }

  struct Order {
    double servo = 0.0;   ///< [rad] where it shall go
    runtime::Time since;  ///< when it was first sent there
  };
  /// The newest order that makes a turn; nothing before the first.
  const std::optional<Order>& order() const { return order_; }

 private:
  void command();

  runtime::Host& host_;
  kinematics::TiltServo servo_;
  double wanted_ = 0.0;  // [rad] servo
  double held_ = 0.0;
  runtime::Time held_until_{};
  std::optional<Order> order_;
  runtime::Input<usher_msgs::msg::SupervisorStatus> state_;
  runtime::Input<usher_msgs::msg::CameraTilt> request_;
  runtime::Output<usher_msgs::msg::CameraTilt> command_;
  runtime::Timer timer_;
};

}  // namespace usher::depth_pipeline
