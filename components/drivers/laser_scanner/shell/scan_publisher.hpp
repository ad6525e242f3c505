#pragma once

#include "drivers/laser_scanner/core/scan.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::laser_scanner {

/// What differs from model to model: the defaults of the parameters of these names, and how long a
/// simulated scanner may be silent.
struct Model {
  double range_min;  ///< [m]
  double range_max;  ///< [m]
  runtime::Duration silence;
};

/// Scans become messages, the mount becomes a static transform.
class ScanPublisher {
 public:
  ScanPublisher(runtime::Host& host, const Model& model);
  void publish(const Scan& scan);

 private:
  float range_min_, range_max_;
  runtime::Output<sensor_msgs::msg::LaserScan> scan_;
  runtime::Output<tf2_msgs::msg::TFMessage> mount_;
};

}  // namespace usher::laser_scanner
