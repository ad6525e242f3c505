#pragma once

#include <optional>
#include <string>

#include "drivers/segway_rmp/core/device.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::segway_rmp {

/// Where the wheels say that the robot is.
///
/// The odometers turn with the body: a base that leans forward by an angle over standing wheels
/// counts wheel radius times angle backward, which the thesis saw as drift at every acceleration
/// (section 8.1.1). The pitch is measured, so this is taken out: what remains is the way over the
/// floor. The raw pose stays available for comparison.
class Odometry {
 public:
  struct Parameters {
    double wheel_radius = 0.2355;  ///< [m] {> 0}
    double track = 0.5398;         ///< [m] {> 0} effective, for turning
    double longest_step = 1.0;     ///< [m] {> 0} between two cycles; more is not believed
    double longest_stop = 2.5;     ///< [s] {> 0} x speed: the farthest roll-out without a line
    double hangs_from = 0.05;      ///< [m/s] {> 0} of a wheel that moves and counts no way
    Time hangs_after = std::chrono::milliseconds(250);  ///< {> 0} of that
  };

  /// Of the last cycle, what the way of the next one is counted from.
  struct Wheels {
    double left_travel = 0.0;     ///< [m]
    double right_travel = 0.0;    ///< [m]
    double left_velocity = 0.0;   ///< [m/s]
    double right_velocity = 0.0;  ///< [m/s]
    double pitch = 0.0;           ///< [rad]
  };

  Odometry();
  explicit Odometry(const Parameters& parameters);

  /// One cycle of the base. False, and nothing changed but the reference for the next one, when it
  /// is not finite, a leap, or a repetition: wheels that move and odometers that do not.
  bool update(const SegwayFeedback& feedback);

  /// The line to the base is lost: the velocities are not known, reported as zero. Meanwhile the
  /// base rolls out, and its odometers count on: what they tell afterwards is one arc more, where
  /// it is no longer than a stop takes and in the direction of the last motion. Else, as after a
  /// reset of the counters, the next cycle is a new beginning of the way, wherever they stand.
  void interrupt();

  /// As after an interruption: a driver that ended left its base with these, where it now begins.
  void resume(const Wheels& wheels);
  /// Nothing: no cycle was heard yet.
  std::optional<Wheels> wheels() const { return started_ ? std::optional(last_) : std::nullopt; }

  const geometry::Pose2& pose() const { return pose_; }          ///< of base_footprint in odom
  const geometry::Twist2& twist() const { return twist_; }       ///< over the floor
  const geometry::Pose2& raw_pose() const { return raw_pose_; }  ///< without the pitch taken out
  const geometry::Twist2& raw_twist() const { return raw_twist_; }
  std::uint64_t rejected() const { return rejected_; }

 private:
  Parameters parameters_;
  bool rolled_out(double travel, double velocity) const;

  bool started_ = false;
  bool interrupted_ = false;
  Wheels last_;
  Time counted_at_{};  ///< when the odometers last changed, or had no reason to
  geometry::Pose2 pose_;
  geometry::Twist2 twist_;
  geometry::Pose2 raw_pose_;
  geometry::Twist2 raw_twist_;
  std::uint64_t rejected_ = 0;
};

/// One line.
std::string to_text(const Odometry::Wheels& wheels);
/// Nothing where that is no such line, or not finite.
std::optional<Odometry::Wheels> read_wheels(const std::string& text);

}  // namespace usher::segway_rmp
