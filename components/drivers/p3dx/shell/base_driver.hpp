#pragma once

#include <functional>
#include <string>

#include "drivers/base_obedience/core/base_obedience.hpp"
#include "drivers/p3dx/core/device.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::p3dx {

/// What a base can be told, real or simulated.
struct Device {
  std::function<void(const geometry::Twist2&)> drive;
  std::function<void()> emergency_stop;
  std::function<void()> reset;
};

/// What the real and the simulated base have in common: obedience, frames, status, sonars. Reports
/// at 100 Hz: between two reports of the base the pose follows its measured velocity.
class BaseDriver {
 public:
  BaseDriver(runtime::Host& host, Device device);

  /// A report of the base came in.
  void take(const Feedback& feedback);
  /// The base is not heard; why.
  void disconnected(const std::string& reason);
  /// The base is heard, but not well; empty when it is.
  void warn(const std::string& reason);

 private:
  void cycle();
  void take_request(const usher_msgs::msg::BaseRequest& request);
  void publish_odometry(const geometry::Pose2& pose, runtime::Time stamp);
  void publish_status(runtime::Time stamp);
  void publish_sonar();
  void publish_battery();
  void place_frames();

  runtime::Host& host_;
  Device device_;
  drive::BaseObedience obedience_;
  double wheel_radius_, ring_radius_, ring_height_;
  drive::Decision decision_;
  Feedback feedback_;
  std::string disconnected_ = "not heard yet";
  std::string warning_;
  std::uint64_t last_request_ = 0;
  std::uint64_t& foreign_;

  runtime::Input<usher_msgs::msg::DriveGrant> grant_;
  runtime::Input<usher_msgs::msg::DriveCommand> command_;
  runtime::Input<usher_msgs::msg::BaseRequest> request_;
  runtime::Output<usher_msgs::msg::BaseStatus> status_;
  runtime::Output<nav_msgs::msg::Odometry> odom_;
  runtime::Output<tf2_msgs::msg::TFMessage> transforms_;
  runtime::Output<tf2_msgs::msg::TFMessage> mounts_;
  runtime::Output<sensor_msgs::msg::LaserScan> sonar_;
  runtime::Output<sensor_msgs::msg::BatteryState> battery_;
  runtime::Timer cycle_timer_;
  runtime::Timer sonar_timer_;
  runtime::Timer slow_timer_;
};

}  // namespace usher::p3dx
