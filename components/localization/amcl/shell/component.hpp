#pragma once

#include <optional>
#include <string>

#include "idl/topics.hpp"
#include "localization/amcl/core/amcl.hpp"
#include "runtime/api/host.hpp"
#include "wire/keeper.hpp"
#include "wire/transform_input.hpp"

namespace usher::amcl {

/// Localizes the robot in the map: scan and odometry in, pose and map -> odom out.
class AmclComponent final : public runtime::Component {
 public:
  explicit AmclComponent(runtime::Host& host);

 private:
  static AmclConfig read_parameters(runtime::Host& host);
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_initial_pose(const geometry_msgs::msg::PoseWithCovarianceStamped& message);
  void take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan, runtime::Time effective);
  void update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp, runtime::Time effective,
              const geometry::Pose2& odom_T_base);
  void start(const geometry::Pose2& odom_T_base);
  void publish_transform(runtime::Time stamp);
  void publish_pose(runtime::Time stamp);
  void publish_status();
  void publish_cloud();
  void keep();

  runtime::Host& host_;
  Amcl core_;
  std::optional<geometry::Pose2> site_pose_;  ///< nothing: start globally
  double initial_position_sigma_ = 0.5, initial_yaw_sigma_ = 0.25;
  bool started_ = false;
  bool map_known_ = false;
  std::uint64_t map_fingerprint_ = 0;
  std::string refused_memory_;  ///< why the kept pose was not taken up; until there is a good one
  runtime::Time last_scan_{};   ///< its stamp, on the clock of the host that it came from
  runtime::Time last_used_{};   ///< when that was, on this host's clock
  runtime::Duration scan_interval_{};  ///< between the last two
  bool doubtful_ = false;              ///< since a gap, until a scan fits where it believes to be
  runtime::Time valid_until_{};        ///< of map -> odom, as it was told
  std::uint64_t& rejected_scans_;
  std::uint64_t& rejected_odometry_;
  std::uint64_t& odometry_leaps_;
  std::uint64_t& rejected_maps_;
  std::uint64_t& rejected_poses_;
  std::uint64_t& bad_beams_;

  wire::Keeper memory_;  ///< the last good pose
  wire::TransformInput transforms_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<geometry_msgs::msg::PoseWithCovarianceStamped> initial_pose_;
  runtime::Output<tf2_msgs::msg::TFMessage> transform_;
  runtime::Output<geometry_msgs::msg::PoseWithCovarianceStamped> pose_;
  runtime::Output<usher_msgs::msg::LocalizationStatus> status_;
  runtime::Output<geometry_msgs::msg::PoseArray> cloud_;
  runtime::Timer status_timer_;
  runtime::Timer slow_timer_;
};

}  // namespace usher::amcl
