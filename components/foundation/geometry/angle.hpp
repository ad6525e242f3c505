#pragma once

#include <cmath>
#include <numbers>

namespace usher::geometry {

inline constexpr double kPi = std::numbers::pi;

constexpr double radians(double degrees) { return degrees * kPi / 180.0; }
constexpr double degrees(double radians) { return radians * 180.0 / kPi; }

/// The same direction in [-pi, pi] rad. NaN and infinity give NaN.
inline double normalized(double angle) { return std::remainder(angle, 2.0 * kPi); }

/// The shortest turn from one direction to another, in [-pi, pi] rad, positive counter-clockwise.
inline double shortest_turn(double from, double to) { return normalized(to - from); }

}  // namespace usher::geometry
