#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace usher::kinematics {

/// The joints of the humanoid torso, in the order of every list of them.
enum class TorsoJoint : std::uint8_t {
  kLeftShoulder,   ///< [rad] extended forward is positive
  kRightShoulder,  ///< [rad] extended forward is positive
  kTorsoTilt,      ///< [rad] leaning to its left is positive
  kHeadRise,       ///< [m] the neck extended is positive
  kHeadTilt,       ///< [rad] leaning to its left is positive
  kHeadNod,        ///< [rad] looking up is positive
  kHeadShake,      ///< [rad] looking to its left is positive
};
inline constexpr std::size_t kTorsoJoints = 7;
inline constexpr std::array<std::string_view, kTorsoJoints> kTorsoJointNames{
    "left_shoulder", "right_shoulder", "torso_tilt", "head_rise",
    "head_tilt",     "head_nod",       "head_shake"};

constexpr bool is_length(std::size_t joint) {
  return joint == static_cast<std::size_t>(TorsoJoint::kHeadRise);
}

/// Where each joint is, or shall be [rad; m for kHeadRise].
using TorsoPose = std::array<double, kTorsoJoints>;

inline bool finite(const TorsoPose& pose) {
  return std::all_of(pose.begin(), pose.end(), [](double joint) { return std::isfinite(joint); });
}

/// What a joint can do; as built, without a torso, it does not move at all.
struct JointLimits {
  double low = 0.0;   ///< [rad, m]
  double high = 0.0;  ///< [rad, m] {>= low}
  double rate = 0.0;  ///< [rad/s, m/s] {>= 0}

  bool holds(double value) const { return value >= low && value <= high; }
};
using TorsoLimits = std::array<JointLimits, kTorsoJoints>;

/// There is a torso: some joint can move.
inline bool moves(const TorsoLimits& limits) {
  return std::any_of(limits.begin(), limits.end(),
                     [](const JointLimits& joint) { return joint.high > joint.low; });
}

/// `from`, moved toward `to` within the limits and by no more than their rates allow in `seconds`.
/// All values finite.
inline TorsoPose moved(const TorsoPose& from, const TorsoPose& to, const TorsoLimits& limits,
                       double seconds) {
  TorsoPose pose = from;
  for (std::size_t i = 0; i < kTorsoJoints; ++i) {
    const double step = limits[i].rate * seconds;
    const double target = std::clamp(to[i], limits[i].low, limits[i].high);
    pose[i] = std::clamp(target, from[i] - step, from[i] + step);
  }
  return pose;
}

/// Red, green, blue {0..1}.
using EyeColor = std::array<float, 3>;

/// `color` at a part of its brightness; what is not finite is dark.
inline EyeColor dimmed(const EyeColor& color, double factor) {
  EyeColor result{};
  for (std::size_t i = 0; i < color.size(); ++i) {
    const double value = static_cast<double>(color[i]) * factor;
    result[i] = std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0)) : 0.0F;
  }
  return result;
}

}  // namespace usher::kinematics
