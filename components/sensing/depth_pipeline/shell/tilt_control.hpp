#pragma once

#include "foundation/kinematics/tilt_servo.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::depth_pipeline {

/// Keeps the Kinect's tilt where the robot's state wants it: low to navigate, high to see faces; an
/// operator's request holds it elsewhere for two seconds.
class TiltControl {
 public:
  explicit TiltControl(runtime::Host& host);

  const kinematics::TiltServo& servo() const { return servo_; }

 private:
  void command();

  runtime::Host& host_;
  kinematics::TiltServo servo_;
  double wanted_ = 0.0;  // [rad] servo
  double held_ = 0.0;
  runtime::Time held_until_{};
  runtime::Input<usher_msgs::msg::SupervisorStatus> state_;
  runtime::Input<usher_msgs::msg::CameraTilt> request_;
  runtime::Output<usher_msgs::msg::CameraTilt> command_;
  runtime::Timer timer_;
};

}  // namespace usher::depth_pipeline
