#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "foundation/geometry/pose2.hpp"

namespace usher::movement_control {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// How much room there is, in rising order: the three classes of the thesis, section 8.1.3.
enum class Situation : std::uint8_t { kConfined = 0, kCorridor = 1, kOpen = 2 };

std::string_view text(Situation situation);

/// The free room in front of the robot.
struct FreeSpace {
  double ahead =
      0.0;  ///< [m] from the axle to the first thing in the robot's way; at most the horizon
  double width = 0.0;  ///< [m] narrowest free width across the way; at most twice the horizon
};

struct FreeSpaceParameters {
  double half_width = 0.35;  ///< [m] {> 0} of the robot's way
  double look_ahead = 2.0;   ///< [m] {> 0} where the width is looked at
  double horizon = 6.0;      ///< [m] {> look_ahead} farther away nothing counts
  /// Where the scan was measured, in base_footprint; yaw included.
  geometry::Pose2 base_T_sensor;
};

/// Measures the free room from one horizontal scan. Ranges follow REP 117: +infinity is free, NaN
/// is unknown, -infinity is something too near to measure. The width is measured in
/// slices of 0.25 m, so a robot that stands askew in a corridor still finds nearly the corridor's
/// width. Nothing when no beam points forward, or half of those are unknown. O(beams), no
/// allocation.
std::optional<FreeSpace> free_space(std::span<const float> ranges, double angle_min,
                                    double angle_increment, const FreeSpaceParameters& parameters);

/// Room that a class needs: wide enough as an area, or narrower but long, as a corridor.
struct RoomNeeded {
  double area_width = 0.0;      ///< [m]
  double area_ahead = 0.0;      ///< [m]
  double corridor_width = 0.0;  ///< [m]
  double corridor_ahead = 0.0;  ///< [m]
};

/// Follows the situation from scan to scan: narrower at once, wider only when it has been wide for
/// a while, so that a gap between two chairs does not make the robot hurry.
class SituationFilter {
 public:
  struct Parameters {
    /// Half an area's side lies ahead of a robot in its middle.
    RoomNeeded open{4.0, 2.0, 2.5, 4.0};      ///< areas of 4 x 4 m, corridors of 2.5 m
    RoomNeeded corridor{3.0, 1.5, 1.4, 3.0};  ///< areas of 3 x 3 m, corridors of 1.4 m
    double tolerance = 0.06;                  ///< [m] {>= 0} both walls' systematic range error
    Time settle = std::chrono::milliseconds(500);  ///< {>= 0}
  };

  SituationFilter();
  explicit SituationFilter(const Parameters& parameters);

  /// One measurement; nothing is the narrowest.
  Situation update(const std::optional<FreeSpace>& space, Time now);
  Situation situation() const { return situation_; }

  /// The class of one measurement, unfiltered.
  Situation classify(const FreeSpace& space) const;

 private:
  Parameters parameters_;
  Situation situation_ = Situation::kConfined;
  std::optional<Time> wider_since_;
  Situation wider_ = Situation::kConfined;  ///< the narrowest seen since then
};

}  // namespace usher::movement_control
