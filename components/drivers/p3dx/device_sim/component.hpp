#pragma once

#include <optional>

#include "drivers/base_obedience/shell/simulated_base.hpp"
#include "drivers/p3dx/shell/base_driver.hpp"
#include "foundation/kinematics/differential_drive.hpp"

namespace usher::p3dx {

/// The driver over a simulated base. Its sonars fire all at once, those of a real one in turn.
class P3dxSimComponent final : public runtime::Component {
 public:
  explicit P3dxSimComponent(runtime::Host& host);

 private:
  void take(const usher_sim_msgs::msg::BaseFeedback& message);
  void take_sonar(const usher_sim_msgs::msg::SensorBoardReading& message);

  kinematics::DifferentialDrive wheels_;
  std::optional<kinematics::WheelSpeeds> travel_;  ///< [m] of the last feedback
  Feedback feedback_;
  Time fires_at_{};  ///< all sonars, again
  std::uint64_t& rejected_;
  drive::SimulatedBase base_;
  BaseDriver driver_;
  runtime::Input<usher_sim_msgs::msg::SensorBoardReading> sonar_;
};

}  // namespace usher::p3dx
