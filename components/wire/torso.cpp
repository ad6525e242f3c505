#include "wire/torso.hpp"

#include <string>

namespace usher::wire {

kinematics::TorsoLimits read_torso_limits(runtime::Host& host) {
  auto& p = host.parameters();
  const double turn_rate =
      p.number("robot.torso.turn_rate", "rad/s", {0.01, 3}, 0.5, "Of the torso's joints, at most.");
  const double rise_rate =
      p.number("robot.torso.rise_rate", "m/s", {0.001, 0.5}, 0.04, "Of the neck, at most.");
  kinematics::TorsoLimits limits;
  for (std::size_t i = 0; i < kinematics::kTorsoJoints; ++i) {
    const std::string name = "robot.torso." + std::string(kinematics::kTorsoJointNames[i]);
    const bool length = kinematics::is_length(i);
    const auto ends = p.numbers(
        name, length ? "m" : "rad", length ? runtime::Range{-0.5, 0.5} : runtime::Range{-1.6, 1.6},
        2, 2, {0, 0}, "Lowest and highest position of this joint; both 0 where there is none.");
    if (ends.size() != 2) continue;
    if (ends[0] > ends[1]) host.fault(name + ": the lowest position comes first");
    limits[i] = {ends[0], ends[1], length ? rise_rate : turn_rate};
  }
  return limits;
}

}  // namespace usher::wire
