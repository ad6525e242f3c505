#pragma once

#include "drivers/sensor_board/core/device.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::sensor_board {

/// What the real and the simulated board have in common: five ultrasonic ranges become one scan
/// seen from the middle of their ring, the switches become whiskers, the mount a static transform.
class BoardPublisher {
 public:
  explicit BoardPublisher(runtime::Host& host);
  void publish(const Reading& reading);

 private:
  float ring_radius_, spacing_, range_min_, range_max_;
  std::uint64_t readings_ = 0;
  runtime::Output<sensor_msgs::msg::LaserScan> ultrasonic_;
  runtime::Output<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Output<tf2_msgs::msg::TFMessage> mount_;
};

}  // namespace usher::sensor_board
