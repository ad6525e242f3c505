#pragma once

#include "drivers/urg04lx/shell/scan_publisher.hpp"

namespace usher::urg04lx {

/// The driver over a simulated scanner.
class Urg04lxSimComponent final : public runtime::Component {
 public:
  explicit Urg04lxSimComponent(runtime::Host& host);

 private:
  runtime::Host& host_;
  ScanPublisher publisher_;
  Scan scan_;
  runtime::Input<sensor_msgs::msg::LaserScan> input_;
};

}  // namespace usher::urg04lx
