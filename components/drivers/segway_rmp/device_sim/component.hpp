#pragma once

#include "drivers/base_obedience/shell/simulated_base.hpp"
#include "drivers/segway_rmp/shell/base_driver.hpp"

namespace usher::segway_rmp {

/// The driver over a simulated base.
class SegwayRmpSimComponent final : public runtime::Component {
 public:
  explicit SegwayRmpSimComponent(runtime::Host& host);

 private:
  drive::SimulatedBase base_;
  BaseDriver driver_;
};

}  // namespace usher::segway_rmp
