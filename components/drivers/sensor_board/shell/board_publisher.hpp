#pragma once

#include <array>
#include <functional>

#include "drivers/sensor_board/core/device.hpp"
#include "foundation/estimation/median_filter.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::sensor_board {

/// What the real and the simulated board have in common: the medians of five ultrasonic sensors
/// become one scan seen from the middle of their ring, the switches become whiskers, the mount a
/// static transform, and the servo of the camera's tilt goes where it is told to.
class BoardPublisher {
 public:
  /// `set_tilt` is called with each command for the servo that is finite, [rad] up is positive; the
  /// board holds the last one.
  BoardPublisher(runtime::Host& host, std::function<void(double)> set_tilt);
  /// Whiskers of every reading; ranges and tilt of those that measured them.
  void publish(const Reading& reading);

 private:
  std::array<estimation::MedianFilter, kSonars> filters_;
  float ring_radius_, spacing_, range_min_, range_max_;
  std::uint64_t& rejected_tilts_;
  runtime::Output<sensor_msgs::msg::LaserScan> ultrasonic_;
  runtime::Output<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Output<tf2_msgs::msg::TFMessage> mount_;
  runtime::Output<usher_msgs::msg::CameraTilt> tilt_;
  runtime::Input<usher_msgs::msg::CameraTilt> tilt_command_;
};

}  // namespace usher::sensor_board
