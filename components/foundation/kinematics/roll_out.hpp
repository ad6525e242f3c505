#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "foundation/geometry/pose2.hpp"

namespace usher::kinematics {

/// What to tell a base that must stand now, so that it stays on its arc while it rolls out. A
/// balancing base that is told zero leans back first and rolls on for 1.48 s x v (thesis, table
/// 8.1) while its turn rate is gone after 0.2 s: straight on, off the arc that was free, into the
/// door post. So the forward velocity is zero at once, and the turn rate falls with the measured
/// speed.
class RollOut {
 public:
  static constexpr double kStanding = 0.08;                          ///< [m/s] slower it stands
  static constexpr auto kLongest = std::chrono::milliseconds(2500);  ///< no stop takes longer

  /// It must stand, and does so much now. Nothing and what is not finite give zero.
  geometry::Twist2 stop(const std::optional<geometry::Twist2>& measured,
                        std::chrono::nanoseconds now) {
    const bool known = measured && measured->finite();
    if (!since_) {
      since_ = now;
      onset_ = known ? *measured : geometry::Twist2{};
    }
    const bool rolls = known && std::abs(onset_.v) > kStanding && now - *since_ < kLongest &&
                       measured->v * onset_.v > 0.0 && std::abs(measured->v) > kStanding;
    if (!rolls) return {};
    return {0.0, onset_.w * std::min(1.0, measured->v / onset_.v)};
  }
  /// It may drive: the next stop begins anew.
  void drive() { since_.reset(); }

 private:
  std::optional<std::chrono::nanoseconds> since_;
  geometry::Twist2 onset_;
};

}  // namespace usher::kinematics
