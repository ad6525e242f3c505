#pragma once

#include "drivers/urg04lx/core/device.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::urg04lx {

/// What the real and the simulated scanner have in common: scans become messages, the mount becomes
/// a static transform.
class ScanPublisher {
 public:
  explicit ScanPublisher(runtime::Host& host);
  void publish(const Scan& scan);

 private:
  runtime::Host& host_;
  float range_min_, range_max_;
  runtime::Output<sensor_msgs::msg::LaserScan> scan_;
  runtime::Output<tf2_msgs::msg::TFMessage> mount_;
};

}  // namespace usher::urg04lx
