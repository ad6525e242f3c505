#pragma once

#include "drivers/sensor_board/core/sonar_faults.hpp"
#include "drivers/sensor_board/shell/board_publisher.hpp"

namespace usher::sensor_board {

/// The driver over a simulated board. That speaks at 50 Hz; ranges and tilt of it are taken at the
/// 20 Hz of a real one.
class SensorBoardSimComponent final : public runtime::Component {
 public:
  explicit SensorBoardSimComponent(runtime::Host& host);

 private:
  void set_tilt(double tilt);
  void take(const usher_sim_msgs::msg::SensorBoardReading& message);

  runtime::Host& host_;
  runtime::Output<usher_sim_msgs::msg::SensorBoardCommand> command_;
  BoardPublisher publisher_;
  Time measure_at_{};  ///< ranges and tilt are taken from then on
  SonarFaults faults_;
  std::uint64_t& rejected_;
  runtime::Input<usher_sim_msgs::msg::SensorBoardReading> input_;
};

}  // namespace usher::sensor_board
