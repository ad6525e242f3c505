#pragma once

#include "foundation/kinematics/torso.hpp"
#include "simulation/world/core/base.hpp"

namespace usher::world {

/// The humanoid torso: servos that go where they are told as fast as they can and stand there, and
/// eyes. It changes neither the robot's balance nor what touches it. Steps of kStep.
class Torso {
 public:
  explicit Torso(const kinematics::TorsoLimits& limits) : limits_(limits) {}

  /// False for a robot without one.
  bool exists() const { return kinematics::moves(limits_); }

  /// Finite.
  void command(const kinematics::TorsoPose& joints, const kinematics::EyeColor& left,
               const kinematics::EyeColor& right) {
    wanted_ = joints;
    left_eye_ = kinematics::dimmed(left, 1.0);
    right_eye_ = kinematics::dimmed(right, 1.0);
  }
  void step() { joints_ = kinematics::moved(joints_, wanted_, limits_, kStep); }

  const kinematics::TorsoPose& joints() const { return joints_; }
  const kinematics::EyeColor& left_eye() const { return left_eye_; }
  const kinematics::EyeColor& right_eye() const { return right_eye_; }

 private:
  kinematics::TorsoLimits limits_;
  kinematics::TorsoPose joints_{};
  kinematics::TorsoPose wanted_{};
  kinematics::EyeColor left_eye_{};
  kinematics::EyeColor right_eye_{};
};

}  // namespace usher::world
