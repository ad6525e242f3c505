#pragma once

#include "control/manual_control/core/manual_control.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "wire/repeater.hpp"

namespace usher::manual_control {

/// An operator's sticks as `cmd_vel/manual`, the buttons as requests to the supervisor.
class ManualControlComponent final : public runtime::Component {
 public:
  explicit ManualControlComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Parameters& parameters);
  Time now() const { return host_.now().time_since_epoch(); }
  void take(const sensor_msgs::msg::Joy& joy, const runtime::SampleInfo& info);
  const std::string& name_of(const runtime::Guid& writer);
  void drive();
  void ask(Wish wish);

  runtime::Host& host_;
  ManualControl core_;
  std::uint64_t& rejected_;
  wire::Repeater<usher_msgs::msg::SupervisorRequest> requests_;
  runtime::Time asked_at_{};
  bool asks_to_stop_ = false;  ///< as long as that is not answered

  runtime::Input<sensor_msgs::msg::Joy> joy_;
  runtime::WriterInfo heard_;  ///< the newest sample's writer; empty where it is not known yet
  runtime::Input<usher_msgs::msg::SupervisorStatus> supervisor_;
  runtime::Output<geometry_msgs::msg::TwistStamped> command_;
  runtime::Timer timer_;
};

}  // namespace usher::manual_control
