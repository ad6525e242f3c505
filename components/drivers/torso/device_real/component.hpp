#pragma once

#include "drivers/torso/core/link.hpp"
#include "drivers/torso/shell/torso_driver.hpp"

namespace usher::torso {

/// The driver over the board's serial line.
class TorsoComponent final : public runtime::Component {
 public:
  explicit TorsoComponent(runtime::Host& host);

 private:
  Time now() const { return host_.now().time_since_epoch(); }
  void tick();

  runtime::Host& host_;
  Link link_;
  TorsoDriver driver_;
  runtime::Stream* stream_ = nullptr;
  std::uint64_t& lost_;
  std::uint64_t& damaged_;
  std::uint64_t& senseless_;
  runtime::Timer timer_;
};

}  // namespace usher::torso
