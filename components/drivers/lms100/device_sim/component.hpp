#pragma once

#include "drivers/laser_scanner/shell/simulated_scanner.hpp"

namespace usher::lms100 {

/// The driver over a simulated scanner.
class Lms100SimComponent final : public runtime::Component {
 public:
  explicit Lms100SimComponent(runtime::Host& host);

 private:
  laser_scanner::SimulatedScanner scanner_;
};

}  // namespace usher::lms100
