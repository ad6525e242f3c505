#pragma once

#include "drivers/sensor_board/shell/board_publisher.hpp"

namespace usher::sensor_board {

/// The driver over a simulated board.
class SensorBoardSimComponent final : public runtime::Component {
 public:
  explicit SensorBoardSimComponent(runtime::Host& host);

 private:
  void set_tilt(double tilt);
  void take(const usher_sim_msgs::msg::SensorBoardReading& message);

  runtime::Host& host_;
  runtime::Output<usher_sim_msgs::msg::SensorBoardCommand> command_;
  BoardPublisher publisher_;
  std::uint64_t& rejected_;
  runtime::Input<usher_sim_msgs::msg::SensorBoardReading> input_;
};

}  // namespace usher::sensor_board
