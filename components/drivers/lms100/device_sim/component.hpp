#pragma once

#include "drivers/lms100/shell/scan_publisher.hpp"

namespace usher::lms100 {

/// The driver over a simulated scanner.
class Lms100SimComponent final : public runtime::Component {
 public:
  explicit Lms100SimComponent(runtime::Host& host);

 private:
  runtime::Host& host_;
  ScanPublisher publisher_;
  Scan scan_;
  runtime::Input<sensor_msgs::msg::LaserScan> input_;
};

}  // namespace usher::lms100
