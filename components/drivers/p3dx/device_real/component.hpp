#pragma once

#include "drivers/p3dx/core/link.hpp"
#include "drivers/p3dx/shell/base_driver.hpp"

namespace usher::p3dx {

/// The driver over the controller's serial line.
class P3dxComponent final : public runtime::Component {
 public:
  explicit P3dxComponent(runtime::Host& host);

 private:
  static Link::Parameters read_parameters(runtime::Parameters& parameters);
  Time now() const { return host_.now().time_since_epoch(); }

  runtime::Host& host_;
  Link link_;
  geometry::Twist2 wanted_;
  runtime::Stream* stream_ = nullptr;
  std::uint64_t& damaged_;
  BaseDriver driver_;
  runtime::Timer timer_;
};

}  // namespace usher::p3dx
