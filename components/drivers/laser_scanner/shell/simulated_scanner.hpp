#pragma once

#include "drivers/laser_scanner/shell/scan_publisher.hpp"

namespace usher::laser_scanner {

/// A scanner in the simulated world.
class SimulatedScanner {
 public:
  SimulatedScanner(runtime::Host& host, const Model& model);

 private:
  void take(const sensor_msgs::msg::LaserScan& message);

  runtime::Host& host_;
  ScanPublisher publisher_;
  Scan scan_;
  runtime::Input<sensor_msgs::msg::LaserScan> input_;
};

}  // namespace usher::laser_scanner
