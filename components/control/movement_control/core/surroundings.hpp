#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "control/movement_control/core/situation.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::movement_control {

/// One horizontal scan; ranges as in free_space().
struct ScanView {
  std::span<const float> ranges;  ///< [m]
  double angle_min = 0.0;         ///< [rad]
  double angle_increment = 0.0;   ///< [rad]
};

/// Points of what stands around the robot, in base_footprint: what the laser sees, and near the
/// robot what it cannot see any more. A laser on the robot's front sees neither what is beside the
/// robot's back nor, the LMS100, what is nearer than half a metre: the wall that one is about to
/// touch.
///
///  - What was seen within `near` and is now out of view (beyond the scan's ends, on a beam without
///    measurement, or behind something) stays, moved by the measured velocity, until all beams
///    within 2 cm of it pass, the robot has gone `longest_way` or `longest_turn`, or, beyond the
///    scan's ends, `longest` has passed.
///  - A wall that leaves the view beside the robot goes on straight for `continued`.
///
/// Deterministic; allocates when made only.
class Surroundings {
 public:
  struct Parameters {
    geometry::Pose2 base_T_sensor;
    double horizon = 6.0;                     ///< [m] {> 0} farther away nothing counts
    double near = 1.0;                        ///< [m] {> 0} from the axle's middle: is remembered
    double longest_way = 1.5;                 ///< [m] {> 0} driven since a point was seen
    double longest_turn = 3.2;                ///< [rad] {> 0} turned since
    Time longest = std::chrono::seconds(30);  ///< {> 0} since a point beyond the ends was seen
    double continued = 0.8;  ///< [m] {>= 0} so far goes on a wall that leaves the view
  };

  explicit Surroundings(const Parameters& parameters);

  /// The robot moved so: to be called again and again, nothing and what is not finite stand.
  void move(const std::optional<geometry::Twist2>& measured, Time now);
  /// No scan comes any more: what was seen may have gone.
  void forget();
  /// A new scan; `now` as in move().
  void take(const ScanView& scan, Time now);

  /// Nearest first is not promised. Valid until the next call.
  std::span<const geometry::Point2> points() const { return points_; }
  /// So many of them, the last, are walls that go on: nobody has seen them.
  std::size_t guessed() const { return points_.size() - seen_; }

 private:
  struct Remembered {
    geometry::Point2 point;
    double way = 0.0, turn = 0.0;  ///< of the robot since it started, when the point was seen
    Time seen{};
  };

  geometry::Point2 end_of(const ScanView& scan, std::size_t beam) const;
  bool hidden(const ScanView& scan, const Remembered& each, Time now) const;
  void remember(const ScanView& scan, Time now);
  void go_on(const ScanView& scan, bool left);

  Parameters parameters_;
  std::vector<geometry::Point2> points_;
  std::size_t seen_ = 0;            ///< so many of them, the first, were seen
  std::vector<Remembered> near_;    ///< seen by the last scan
  std::vector<Remembered> hidden_;  ///< seen before
  double way_ = 0.0, turn_ = 0.0;
  std::optional<Time> moved_at_;
};

}  // namespace usher::movement_control
