#pragma once

#include "drivers/segway_rmp/shell/base_driver.hpp"

namespace usher::segway_rmp {

/// The driver over a simulated base.
class SegwayRmpSimComponent final : public runtime::Component {
 public:
  explicit SegwayRmpSimComponent(runtime::Host& host);

 private:
  void send(std::uint8_t mode, const geometry::Twist2& twist);

  /// What was asked besides driving, told with every command until the base shows it: the topic
  /// keeps one sample only.
  std::uint8_t pending_ = 0;
  runtime::Output<usher_sim_msgs::msg::BaseCommand> command_;
  BaseDriver driver_;
  runtime::Input<usher_sim_msgs::msg::BaseFeedback> feedback_;
};

}  // namespace usher::segway_rmp
