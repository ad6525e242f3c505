#pragma once

#include <optional>
#include <vector>

#include "control/movement_control/core/lethal_cells.hpp"
#include "control/movement_control/core/movement_control.hpp"
#include "control/movement_control/core/surroundings.hpp"
#include "control/movement_control/shell/rightful_input.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::movement_control {

/// The one component that writes drive/command. Decides whenever the driving source speaks, and at
/// 50 Hz.
class MovementControlComponent final : public runtime::Component {
 public:
  explicit MovementControlComponent(runtime::Host& host);

 private:
  static Guard::Parameters read_guard(runtime::Host& host);
  static Parameters read_parameters(runtime::Host& host);
  static FreeSpaceParameters read_free_space(runtime::Parameters& parameters,
                                             const geometry::Footprint& outline);
  static std::optional<geometry::Twist2> velocity(
      const RightfulInput<geometry_msgs::msg::TwistStamped>& source);
  std::optional<geometry::Twist2> measured() const;
  bool sees() const;
  Guard::View view(double speed);
  std::span<const geometry::Point2> cells(double reach);
  std::optional<std::span<const geometry::Point2>> people();
  Inputs gather();
  std::optional<bool> person_ahead() const;
  void take_scan(const sensor_msgs::msg::LaserScan& scan);
  void decide();
  void publish_status();

  runtime::Host& host_;
  Parameters parameters_;
  FreeSpaceParameters free_space_;
  bool assume_person_;
  double low_battery_;
  MovementControl core_;
  Surroundings surroundings_;
  LethalCells lethal_;
  std::vector<geometry::Point2> around_;  ///< people, in base_footprint
  runtime::Duration scan_silence_{};
  std::optional<Time> leaned_at_;
  std::optional<Time> seen_at_;  ///< when a scan last told what is ahead; none: no scan comes
  SituationFilter situation_;
  std::uint64_t number_ = 0;
  std::uint64_t& rejected_;
  std::uint64_t& held_back_;
  std::uint64_t& rejected_costs_;

  std::vector<drive::NamedComponent> manifest_;
  RightfulInput<usher_msgs::msg::MovementEnable> enable_;
  RightfulInput<geometry_msgs::msg::TwistStamped> manual_;
  RightfulInput<geometry_msgs::msg::TwistStamped> interaction_;
  RightfulInput<geometry_msgs::msg::TwistStamped> navigation_;
  runtime::Input<usher_msgs::msg::Whiskers> whiskers_;
  runtime::Input<usher_msgs::msg::BaseStatus> base_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Input<usher_msgs::msg::Costmap> costs_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::LocalizationStatus> localization_;
  runtime::Input<usher_msgs::msg::PersonAhead> person_;
  runtime::Input<usher_msgs::msg::People> people_;
  runtime::Output<usher_msgs::msg::DriveCommand> command_;
  runtime::Output<usher_msgs::msg::MovementStatus> status_;
  runtime::Timer command_timer_;
  runtime::Timer status_timer_;
};

}  // namespace usher::movement_control
