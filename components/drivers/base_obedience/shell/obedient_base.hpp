#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>

#include "drivers/base_obedience/core/base_obedience.hpp"
#include "drivers/base_obedience/core/writer_right.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/roll_out.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "wire/keeper.hpp"

namespace usher::drive {

/// What a base can be told, real or simulated.
struct BaseDevice {
  std::function<void(const geometry::Twist2&)> drive;
  std::function<void()> emergency_stop;
  std::function<void()> reset;
  /// What its guard shall tell it for so long where this driver hangs or ends.
  std::function<void(const geometry::Twist2&, runtime::Duration)> last_will =
      [](const geometry::Twist2&, runtime::Duration) {};
};

/// What a base says of itself.
struct BaseReport {
  Time stamp{};             ///< on the host's clock
  std::uint8_t state = 0;   ///< BaseStatus_Constants STATE_*
  double pitch = 0.0;       ///< [rad] positive leans forward; 0 for a base that cannot lean
  double pitch_rate = 0.0;  ///< [rad/s]
  geometry::Twist2 twist;   ///< measured, over the floor
  double battery_percent = std::numeric_limits<double>::quiet_NaN();  ///< {0..100, NaN unknown}
};

/// What every base driver has in common: it obeys drive/command under drive/grant and nothing else
/// (BaseObedience decides), passes requests on, reports status, odometry, frames and battery.
class ObedientBase {
 public:
  /// The device is told what to drive at every command, every loss of one and every 10 ms.
  /// `wheel_radius` [m] is the default of robot.wheel_radius. `cycled` is called after each of
  /// these cycles.
  ObedientBase(
      runtime::Host& host, BaseDevice device, double wheel_radius,
      std::function<void()> cycled = [] {});

  /// The base is heard.
  void report(const BaseReport& report);
  /// The base is not heard; why. Said again every second.
  void disconnected(const std::string& reason);
  bool connected() const { return disconnected_.empty(); }

  /// `pose` of base_footprint since this driver's start; odom is kept over restarts of the driver,
  /// so that what is mapped in it stays where it is. A boot begins a new one.
  void publish_odometry(Time stamp, const geometry::Pose2& pose, const geometry::Twist2& twist,
                        double pitch = 0.0);

  /// What a driver wants kept with the pose, one line, to count what its base rolls on without it.
  void keep_beside_odometry(std::function<std::string()> line) { beside_ = std::move(line); }
  /// What an earlier life of it kept there; empty: nothing.
  const std::string& found_beside_odometry() const { return found_beside_; }

  double wheel_radius() const { return wheel_radius_; }  ///< [m]

 private:
  bool may_grant(const runtime::Guid& writer, runtime::Time written);
  void cycle();
  /// What the base gets: the permitted command, or a stop.
  void drive();
  bool slides() const;
  void take_request(const usher_msgs::msg::BaseRequest& request, const runtime::Guid& writer);
  void publish_status();
  void publish_battery();
  void keep_odometry();

  runtime::Host& host_;
  BaseDevice device_;
  std::function<void()> cycled_;
  BaseObedience obedience_;
  kinematics::StoppingDistance stopping_;
  double wheel_radius_;
  Decision decision_;
  kinematics::RollOut roll_out_;
  BaseReport report_;
  std::string disconnected_ = "not heard yet";
  std::uint64_t last_request_ = 0;
  bool motors_off_ = false;  ///< requested, until a reset
  wire::Keeper odometry_memory_;
  std::string found_beside_;
  std::function<std::string()> beside_ = [] { return std::string(); };
  geometry::Pose2 odom_T_start_, odom_T_base_, kept_odometry_;
  WriterRight grantors_;
  std::uint64_t& foreign_grants_;
  std::uint64_t& foreign_;
  std::uint64_t& foreign_requests_;

  runtime::Input<usher_msgs::msg::DriveGrant> grant_;
  runtime::Input<usher_msgs::msg::DriveCommand> command_;
  runtime::Input<usher_msgs::msg::BaseRequest> request_;
  runtime::Output<usher_msgs::msg::BaseStatus> status_;
  runtime::Output<nav_msgs::msg::Odometry> odom_;
  runtime::Output<tf2_msgs::msg::TFMessage> transforms_;
  runtime::Output<sensor_msgs::msg::BatteryState> battery_;
  runtime::Timer cycle_timer_;
  runtime::Timer battery_timer_;
  runtime::Timer keep_timer_;
};

}  // namespace usher::drive
