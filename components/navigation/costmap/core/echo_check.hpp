#pragma once

#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "navigation/costmap/core/obstacle_layer.hpp"

namespace usher::costmap {

/// One planar scan for comparing two sensors.
struct ComparedScan {
  geometry::Pose2 sensor;         ///< in a frame that both scans share
  double angle_min = 0.0;         ///< [rad] of the first beam
  double angle_increment = 0.0;   ///< [rad] between beams
  std::span<const float> ranges;  ///< [m] REP 117
};

/// An ultrasonic echo comes from anywhere in a wide cone: put on the cone's axis, a wall that is
/// met at an angle seems to stand inside the corridor. What the laser sees in the cone at that
/// distance or a little nearer, with three neighbouring beams, explains the echo, and the laser's
/// own layer has it at its right place; what it sees much nearer, or behind, does not. What remains
/// is what ultrasonic
/// sensors are for: glass, which the laser looks through but for a beam here and there.
///
/// Sets every range of `echoes` to NaN (nothing known) that `laser` explains within `half_cone`
/// [rad] and so much nearer, `tolerance` [m]. Without a laser scan nothing is explained. O(echoes x
/// beams).
void drop_explained_echoes(const ComparedScan& laser, const ComparedScan& sonar, double half_cone,
                           double tolerance, std::span<float> echoes);

/// Likewise what the laser's layer remembers on the arc of an echo, give or take `tolerance` [m],
/// on three of its rays: the laser does not see what is nearest. `rays` as by cone_directions, in
/// the frame of `window_T_sonar`.
void drop_remembered_echoes(const ObstacleLayer& laser, const Raster& raster,
                            const geometry::Pose2& window_T_sonar,
                            std::span<const geometry::Point2> rays, double tolerance,
                            std::span<float> echoes);

/// An echo tells that something stands somewhere on the arc of its cone, and nothing nearer: as
/// `beams` (odd) rays that fan out by `cone` [rad] around each sensor's axis. Directions in the
/// sensors' frame, in the order of `spread_echoes`.
std::vector<geometry::Point2> cone_directions(double angle_min, double angle_increment,
                                              std::size_t sensors, double cone, int beams);
/// Each echo once for every ray of its cone, up to 0.25 m beside its axis: farther the arc's ends
/// are too far from each other to be one thing's. On the axis alone, and NaN on the others, is what
/// is near, where the arc is as wide as a cell or two, and what comes from where one of the
/// `people` [m, in the frame of window_T_sonar] is: who walks on would leave the rest of the arc
/// behind.
void spread_echoes(std::span<const float> echoes, std::span<const geometry::Point2> rays,
                   const geometry::Pose2& window_T_sonar, std::span<const geometry::Point2> people,
                   std::vector<float>& ranges);
/// Sets to NaN what is not on the middle rays of its cone, within `width` [rad], and what is no
/// range. What stands at the edge of a cone is heard at one moment and not at the next: that
/// nothing is there is told by the middle only. `rays` and `ranges` as of spread_echoes.
void keep_middle(std::span<const geometry::Point2> rays, std::size_t sensors, double width,
                 std::span<float> ranges);

}  // namespace usher::costmap
