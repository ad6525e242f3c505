#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "drivers/base_obedience/shell/obedient_base.hpp"

namespace usher::drive {

/// The line to a base in the simulated world.
class SimulatedBase {
 public:
  using Feedback = usher_sim_msgs::msg::BaseFeedback;

  explicit SimulatedBase(runtime::Host& host);

  /// What the driver tells to this base.
  BaseDevice device();
  /// To be called once: `take` gets every feedback, `silent` the reason when none comes.
  void listen(std::function<void(const Feedback&)> take,
              std::function<void(const std::string&)> silent);

 private:
  void send(std::uint8_t mode, const geometry::Twist2& twist);

  runtime::Host& host_;
  /// What was asked besides driving, told with every command until the base shows it: the topic
  /// keeps one sample only.
  std::uint8_t pending_;
  runtime::Output<usher_sim_msgs::msg::BaseCommand> command_;
  runtime::Input<Feedback> feedback_;
};

}  // namespace usher::drive
