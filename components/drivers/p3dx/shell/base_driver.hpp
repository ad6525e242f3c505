#pragma once

#include <array>
#include <string>

#include "drivers/base_obedience/shell/obedient_base.hpp"
#include "drivers/p3dx/core/device.hpp"
#include "foundation/estimation/median_filter.hpp"

namespace usher::p3dx {

/// What the real and the simulated base have in common: obedience, sonars, and reports at 100 Hz:
/// between two of the base the pose follows its measured velocity.
class BaseDriver {
 public:
  BaseDriver(runtime::Host& host, drive::BaseDevice device);

  /// A report of the base came in.
  void take(const Feedback& feedback);
  /// The base is not heard; why.
  void disconnected(const std::string& reason);
  /// The base is heard, but not well; empty when it is.
  void warn(const std::string& reason) { warning_ = reason; }

 private:
  void predict();
  void take_sonar(const Feedback& feedback);
  void publish_sonar(Time stamp, const std::array<float, kSonarSlots>& ranges);
  void place_frames();

  runtime::Host& host_;
  drive::ObedientBase base_;
  double ring_radius_, ring_height_;
  Feedback feedback_;
  bool heard_ = false;
  std::string warning_;
  std::array<estimation::MedianFilter, kSonarSlots> filters_;

  runtime::Output<tf2_msgs::msg::TFMessage> mounts_;
  runtime::Output<sensor_msgs::msg::LaserScan> sonar_;
};

}  // namespace usher::p3dx
