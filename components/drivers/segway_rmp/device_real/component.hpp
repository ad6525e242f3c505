#pragma once

#include "drivers/segway_rmp/core/link.hpp"
#include "drivers/segway_rmp/shell/base_driver.hpp"

namespace usher::segway_rmp {

/// The driver over the base's serial line.
class SegwayRmpComponent final : public runtime::Component {
 public:
  explicit SegwayRmpComponent(runtime::Host& host);

 private:
  static Link::Parameters read_parameters(runtime::Parameters& parameters);
  void emergency(bool on);
  Time now() const { return host_.now().time_since_epoch(); }

  runtime::Host& host_;
  Link link_;
  geometry::Twist2 wanted_;
  runtime::Stream* stream_ = nullptr;
  BaseDriver driver_;
  runtime::Timer timer_;
};

}  // namespace usher::segway_rmp
