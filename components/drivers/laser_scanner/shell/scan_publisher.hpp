#pragma once

#include "drivers/laser_scanner/core/repetition.hpp"
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
  /// A scanner that repeats itself is blind: its scans are kept back.
  void publish(const Scan& scan);
  bool repeats() const { return repetition_.repeats(); }
  static constexpr const char* kRepeats = "the scanner repeats the same scan";

 private:
  float range_min_, range_max_;
  Repetition repetition_;
  runtime::Output<sensor_msgs::msg::LaserScan> scan_;
  runtime::Output<tf2_msgs::msg::TFMessage> mount_;
};

}  // namespace usher::laser_scanner
