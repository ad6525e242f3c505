#pragma once

#include "drivers/sensor_board/core/link.hpp"
#include "drivers/sensor_board/shell/board_publisher.hpp"

namespace usher::sensor_board {

/// The driver over the board's serial line.
class SensorBoardComponent final : public runtime::Component {
 public:
  explicit SensorBoardComponent(runtime::Host& host);

 private:
  Time now() const { return host_.now().time_since_epoch(); }
  void tick();

  runtime::Host& host_;
  Link link_;
  BoardPublisher publisher_;
  runtime::Stream* stream_ = nullptr;
  std::uint64_t& lost_;
  std::uint64_t& damaged_;
  runtime::Timer timer_;
};

}  // namespace usher::sensor_board
