#pragma once

#include "drivers/segway_rmp/core/emulated_base.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::segway_rmp {

/// The simulated wheels behind a line that speaks the Segway's own protocol, so that the real
/// driver and its guard drive the simulation.
class SegwayEmulatorComponent final : public runtime::Component {
 public:
  explicit SegwayEmulatorComponent(runtime::Host& host);

 private:
  void obey(const EmulatedBase::Order& order);
  void speak(const usher_sim_msgs::msg::BaseFeedback& message);

  runtime::Host& host_;
  EmulatedBase base_;
  bool emergency_ = false;
  bool resetting_ = false;  ///< until the world shows it
  std::uint64_t& skipped_;
  runtime::Output<usher_sim_msgs::msg::BaseCommand> command_;
  runtime::Input<usher_sim_msgs::msg::BaseFeedback> feedback_;
  runtime::Stream* line_ = nullptr;
};

}  // namespace usher::segway_rmp
