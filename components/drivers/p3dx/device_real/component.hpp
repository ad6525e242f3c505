#pragma once

#include "drivers/base_obedience/shell/base_line.hpp"
#include "drivers/p3dx/core/link.hpp"
#include "drivers/p3dx/shell/base_driver.hpp"
#include "wire/keeper.hpp"

namespace usher::p3dx {

/// The driver over the controller's serial line.
class P3dxComponent final : public runtime::Component {
 public:
  explicit P3dxComponent(runtime::Host& host);

 private:
  static Link::Parameters read_parameters(runtime::Parameters& parameters);
  void remember();

  std::uint64_t& damaged_;
  drive::BaseLine<Link, Feedback> line_;
  BaseDriver driver_;
  wire::Keeper memory_;  ///< what stopped it
};

}  // namespace usher::p3dx
