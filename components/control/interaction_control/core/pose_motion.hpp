#pragma once

#include "foundation/kinematics/torso.hpp"

namespace usher::interaction_control {

/// The torso's way from pose to pose: all joints start and end together along a minimum-jerk curve
/// [flash1985minimumjerk], each no faster than its rate. A new goal, or the wish to hold still,
/// slows the present motion down along its own curve and then begins anew from there: velocities
/// are continuous, and no joint ever leaves the span between the poses that were asked for.
class PoseMotion {
 public:
  struct Parameters {
    kinematics::TorsoLimits limits;
    double pace = 0.8;      ///< {0.1..1} part of the joints' rates
    double shortest = 0.8;  ///< [s] {> 0} of any motion
    double brake = 0.2;     ///< [s] {> 0} from full pace to standstill, and back
  };

  explicit PoseMotion(const Parameters& parameters) : parameters_(parameters) {}

  /// Stands there; finite.
  void start_at(const kinematics::TorsoPose& pose);
  /// Where to go; finite.
  void go_to(const kinematics::TorsoPose& goal) { wanted_ = goal; }
  /// Stands still while it is true, and goes on afterwards.
  void hold(bool still) { still_ = still; }

  /// `seconds` later.
  const kinematics::TorsoPose& step(double seconds);

  const kinematics::TorsoPose& pose() const { return pose_; }
  bool arrived() const { return wanted_ == goal_ && progress_ >= 1.0; }
  /// Joints move now.
  bool moving() const { return pace_ > 0.0 && progress_ < 1.0; }

 private:
  void begin();

  Parameters parameters_;
  kinematics::TorsoPose start_{}, goal_{}, wanted_{}, pose_{};
  double duration_ = 1.0;  ///< [s] of the present motion at full pace
  double progress_ = 1.0;  ///< {0..1} of it, in time
  double pace_ = 0.0;      ///< {0..1} how fast its time goes
  bool still_ = false;
};

}  // namespace usher::interaction_control
