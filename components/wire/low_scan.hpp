#pragma once

#include <cstddef>

#include "idl/topics.hpp"

namespace usher::wire {

/// The intensity of a bearing of `kinect/scan/low` at whose range floor is missing: the edge of a
/// stairway, a hole. That of a thing is its confidence, {0..1}.
inline constexpr float kDrop = 2.0F;

/// A scan without intensities tells of no drops.
inline bool is_drop(const sensor_msgs::msg::LaserScan& low, std::size_t bearing) {
  return bearing < low.intensities().size() && low.intensities()[bearing] == kDrop;
}

}  // namespace usher::wire
