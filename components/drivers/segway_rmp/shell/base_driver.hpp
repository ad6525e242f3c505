#pragma once

#include <functional>
#include <string>

#include "drivers/base_obedience/core/base_obedience.hpp"
#include "drivers/segway_rmp/core/device.hpp"
#include "drivers/segway_rmp/core/odometry.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::segway_rmp {

/// What a base can be told, real or simulated.
struct Device {
  std::function<void(const geometry::Twist2&)> drive;
  std::function<void()> emergency_stop;
  std::function<void()> reset;
};

/// What the real and the simulated base have in common: obedience, odometry, frames, status.
class BaseDriver {
 public:
  BaseDriver(runtime::Host& host, Device device);

  /// One control cycle of the base came in.
  void take(const SegwayFeedback& feedback);
  /// The base is not heard; why.
  void disconnected(const std::string& reason);

 private:
  void cycle();
  void take_request(const usher_msgs::msg::BaseRequest& request);
  void publish_odometry(const SegwayFeedback& feedback);
  void publish_status(const SegwayFeedback& feedback);
  void publish_battery();

  runtime::Host& host_;
  Device device_;
  drive::BaseObedience obedience_;
  Odometry::Parameters geometry_;
  Odometry odometry_;
  drive::Decision decision_;
  SegwayFeedback feedback_;
  std::string disconnected_ = "not heard yet";
  std::uint64_t last_request_ = 0;
  std::uint64_t& rejected_feedback_;
  std::uint64_t& foreign_;

  runtime::Input<usher_msgs::msg::DriveGrant> grant_;
  runtime::Input<usher_msgs::msg::DriveCommand> command_;
  runtime::Input<usher_msgs::msg::BaseRequest> request_;
  runtime::Output<usher_msgs::msg::BaseStatus> status_;
  runtime::Output<nav_msgs::msg::Odometry> odom_;
  runtime::Output<tf2_msgs::msg::TFMessage> transforms_;
  runtime::Output<sensor_msgs::msg::BatteryState> battery_;
  runtime::Timer cycle_timer_;
  runtime::Timer slow_timer_;
};

}  // namespace usher::segway_rmp
