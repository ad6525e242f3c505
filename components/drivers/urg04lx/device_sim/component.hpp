#pragma once

#include "drivers/laser_scanner/shell/simulated_scanner.hpp"

namespace usher::urg04lx {

/// The driver over a simulated scanner.
class Urg04lxSimComponent final : public runtime::Component {
 public:
  explicit Urg04lxSimComponent(runtime::Host& host);

 private:
  laser_scanner::SimulatedScanner scanner_;
};

}  // namespace usher::urg04lx
