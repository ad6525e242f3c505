#pragma once

#include <cstddef>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"

namespace usher::wire {

/// The intensity of a bearing of `kinect/scan/low` at whose range floor is missing: the edge of a
/// stairway, a hole. That of a thing is its confidence, {0..1}.
inline constexpr float kDrop = 2.0F;
/// The same behind floor that the camera sees: nobody hides it.
inline constexpr float kDropBehindFloor = 3.0F;

/// A scan without intensities tells of no drops.
inline bool is_drop(const sensor_msgs::msg::LaserScan& low, std::size_t bearing) {
  return bearing < low.intensities().size() &&
         (low.intensities()[bearing] == kDrop || low.intensities()[bearing] == kDropBehindFloor);
}
inline bool is_drop_behind_floor(const sensor_msgs::msg::LaserScan& low, std::size_t bearing) {
  return bearing < low.intensities().size() && low.intensities()[bearing] == kDropBehindFloor;
}

/// [m] Nearer than this the Kinect looks over low things: an image that does not show the floor
/// from there on tells nothing of them, and costs that are nearer stay.
inline double read_kinect_blind_range(runtime::Parameters& parameters) {
  return parameters.number("robot.kinect.blind_range", "m", {0, 4}, 1.8,
                           "Nearer than this the Kinect looks over low things: what is marked "
                           "there stays.");
}

}  // namespace usher::wire
