#pragma once

#include "control/interaction_control/core/face_controller.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::interaction_control {

/// The robot's pose while it talks: turns on the spot toward whom it is told to face, or searches.
class InteractionControlComponent final : public runtime::Component {
 public:
  explicit InteractionControlComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Parameters& parameters);
  void aim(const usher_msgs::msg::FaceTarget& target);
  void drive();

  runtime::Host& host_;
  FaceController core_;
  std::uint64_t& rejected_;

  runtime::Input<usher_msgs::msg::FaceTarget> target_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::MovementEnable> enable_;
  runtime::Output<geometry_msgs::msg::TwistStamped> command_;
  runtime::Timer timer_;
};

}  // namespace usher::interaction_control
