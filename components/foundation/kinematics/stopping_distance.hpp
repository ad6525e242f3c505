#pragma once

#include <span>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::kinematics {

/// One measurement: told to stop at `speed`, the robot came to rest `distance` further on.
struct StoppingPoint {
  double speed = 0.0;     ///< [m/s]
  double distance = 0.0;  ///< [m]
};

/// The measured stopping distance d(v) of a base, linear between measurements and from (0, 0) to
/// the first, with the last slope beyond the last. A balancing base leans before it slows: its
/// distance grows about linearly with speed (MARVIN: 1.48 s x v), which v^2/2a does not describe.
/// Reverse speeds count by magnitude.
class StoppingDistance {
 public:
  /// MARVIN's standard stop: 1.48 m from 1.0 m/s and 2.08 m from 1.4 m/s (table 8.1 of its thesis).
  StoppingDistance();

  /// At least one point; speeds positive and strictly growing, distances positive and strictly
  /// growing, all finite.
  static Result<StoppingDistance> make(std::span<const StoppingPoint> points);

  /// The way to rest from `speed` [m/s]; never negative, NaN for NaN.
  double distance(double speed) const;
  /// The highest speed [m/s] that comes to rest within `distance` [m]; zero when there is no room
  /// or it is NaN.
  double speed(double distance) const;

 private:
  explicit StoppingDistance(std::vector<StoppingPoint> points) : points_(std::move(points)) {}

  std::vector<StoppingPoint> points_;  // starts with (0, 0)
};

}  // namespace usher::kinematics
