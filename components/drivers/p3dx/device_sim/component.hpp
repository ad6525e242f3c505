#pragma once

#include <optional>

#include "drivers/p3dx/shell/base_driver.hpp"
#include "foundation/kinematics/differential_drive.hpp"

namespace usher::p3dx {

/// The driver over a simulated base.
class P3dxSimComponent final : public runtime::Component {
 public:
  explicit P3dxSimComponent(runtime::Host& host);

 private:
  void send(std::uint8_t mode, const geometry::Twist2& twist);
  void take(const usher_sim_msgs::msg::BaseFeedback& message);
  void take_sonar(const usher_sim_msgs::msg::SensorBoardReading& message);

  /// What was asked besides driving, told with every command until the base shows it: the topic
  /// keeps one sample only.
  std::uint8_t pending_ = 0;
  kinematics::DifferentialDrive wheels_;
  std::optional<kinematics::WheelSpeeds> travel_;  ///< [m] of the last feedback
  Feedback feedback_;
  std::uint64_t& rejected_;
  runtime::Output<usher_sim_msgs::msg::BaseCommand> command_;
  BaseDriver driver_;
  runtime::Input<usher_sim_msgs::msg::BaseFeedback> base_;
  runtime::Input<usher_sim_msgs::msg::SensorBoardReading> sonar_;
};

}  // namespace usher::p3dx
