#pragma once

#include <vector>

#include "control/interaction_control/core/face_controller.hpp"
#include "control/interaction_control/core/posing.hpp"
#include "foundation/geometry/pose2.hpp"
#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::interaction_control {

/// The robot's pose while it talks: turns on the spot toward whom it is told to face, or who stands
/// where it shall, searches while the guide seeks somebody to serve, and poses torso and eyes by
/// where the person stands.
class InteractionControlComponent final : public runtime::Component {
 public:
  explicit InteractionControlComponent(runtime::Host& host);

 private:
  static Parameters read_parameters(runtime::Host& host);
  void aim(const usher_msgs::msg::FaceTarget& target);
  void tick();
  std::vector<Sighting> people_around(const geometry::Pose2& odom_T_base);
  Occasion occasion() const;
  bool listens() const;
  bool hears() const;
  bool seeks() const;
  std::optional<kinematics::TorsoPose> torso() const;
  void pose(const std::optional<geometry::Pose2>& odom_T_base);
  void drive(const std::optional<geometry::Pose2>& odom_T_base);
  void publish_status(bool located);

  runtime::Host& host_;
  Parameters parameters_;
  FaceController face_;
  Zones::Thresholds thresholds_;
  Posing posing_;
  std::uint64_t& rejected_;
  std::uint64_t& rejected_people_;
  int ticks_ = 0;

  runtime::Input<usher_msgs::msg::FaceTarget> target_;
  runtime::Input<nav_msgs::msg::Odometry> odom_;
  runtime::Input<usher_msgs::msg::MovementEnable> enable_;
  runtime::Input<usher_msgs::msg::People> people_;
  runtime::Input<usher_msgs::msg::GuideStatus> guide_;
  runtime::Input<usher_msgs::msg::TorsoStatus> torso_;
  runtime::Input<usher_msgs::msg::SpeechStatus> speech_;
  runtime::Input<usher_msgs::msg::SpeechLevel> level_;
  runtime::Output<geometry_msgs::msg::TwistStamped> command_;
  runtime::Output<usher_msgs::msg::TorsoFrame> frame_;
  runtime::Output<usher_msgs::msg::InteractionStatus> status_;
  runtime::Timer timer_;
};

}  // namespace usher::interaction_control
