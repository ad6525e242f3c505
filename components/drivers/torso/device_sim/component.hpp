#pragma once

#include "drivers/torso/shell/torso_driver.hpp"

namespace usher::torso {

/// The driver over a simulated torso.
class TorsoSimComponent final : public runtime::Component {
 public:
  explicit TorsoSimComponent(runtime::Host& host);

 private:
  void take(const usher_sim_msgs::msg::TorsoReading& message);
  void tick();

  TorsoDriver driver_;
  runtime::Output<usher_sim_msgs::msg::TorsoCommand> command_;
  std::uint64_t& rejected_;
  runtime::Input<usher_sim_msgs::msg::TorsoReading> input_;
  runtime::Timer timer_;
};

}  // namespace usher::torso
