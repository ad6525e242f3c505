#pragma once

/// Frames that every robot has (REP 105): map -> odom -> base_footprint (floor below the axle's
/// middle) -> base_link (the axle's middle, pitched). Sensors hang on base_link under names of
/// their own.
namespace usher::frames {

inline constexpr const char* kMap = "map";
inline constexpr const char* kOdom = "odom";
inline constexpr const char* kBaseFootprint = "base_footprint";
inline constexpr const char* kBaseLink = "base_link";
/// With an id behind it: somebody, below odom. For people who look; components read `people`.
inline constexpr const char* kPerson = "person_";

}  // namespace usher::frames
