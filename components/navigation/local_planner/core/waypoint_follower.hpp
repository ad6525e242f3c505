#pragma once

#include <optional>
#include <span>
#include <vector>

#include "navigation/local_planner/core/dynamic_window.hpp"
#include "navigation/local_planner/core/path_follower.hpp"
#include "navigation/local_planner/core/reference_path.hpp"

namespace usher::local_planner {

/// Defaults are those of the meeting report (III-B-3), where it says so.
struct WaypointFollowerConfig {
  DynamicWindowConfig motion;  ///< speeds, limits, tolerances, stopping, outline; its recoveries
  double heading_tolerance = 0.15;  ///< [rad] it turns to a waypoint up to this, and drives
                                    ///< straight within it; [0.02, 1]
  double waypoint_radius = 0.2;  ///< [m] nearer than this it has arrived at a waypoint; [0.05, 1]
  double safe_distance = 0.5;    ///< [m] an obstacle nearer than this stops it; [0.1, 3]
  double sector_angle = 1.5708;  ///< [rad] 90 deg ahead that are watched; [0.2, 3.1]
  int sectors = 10;              ///< of them, each with its median; [1, 64]
  double lost_heading = 0.8;  ///< [rad] so far off it stops and turns anew; [heading_tolerance, 3]
  double corner_tolerance = 0.05;  ///< [m] by which the waypoints may miss the path; [0.005, 0.5]
};

/// Medians of a laser scan in sectors ahead of the robot: noise and single erroneous readings do
/// not stop it.
class SectorMedians {
 public:
  static constexpr int kMost = 64;

  /// `angle` [rad] ahead, in equal sectors.
  SectorMedians(double angle, int sectors) : angle_(angle), sectors_(sectors) {}

  /// Takes a scan; infinite is no echo, NaN no reading. Ranges and bearings become those from the
  /// robot's middle. A sector without any reading is blind.
  void take(std::span<const float> ranges, double angle_min, double increment,
            const geometry::Pose2& base_T_laser);
  void clear() { medians_.clear(); }

  /// [m] from right to left; infinite: free, 0: blind. Empty before the first scan.
  std::span<const double> medians() const { return medians_; }
  /// [rad] of a sector's middle, left positive.
  double bearing(std::size_t sector) const {
    return angle_ * ((static_cast<double>(sector) + 0.5) / sectors_ - 0.5);
  }
  double nearest() const;

 private:
  double angle_;
  int sectors_;
  std::vector<std::vector<float>> readings_;  // by sector
  std::vector<double> medians_;
};

/// Corners of a path: its first and last point, and between them the fewest points from which no
/// other is farther than `tolerance` [m] [douglas1973reduction].
std::vector<geometry::Point2> corners(std::span<const geometry::Pose2> path, double tolerance);

/// The navigation node of the meeting report: turns to a waypoint, drives to it, straight or, when
/// it is off by more than the tolerance, in a curve; stops where something is nearer than the safe
/// distance ahead. Turns in place and recoveries are the dynamic window's: only where the outline
/// has room. People are no more to it than what its laser sees.
class WaypointFollower final : public PathFollower {
 public:
  /// An error names the value that is out of its range.
  static Result<WaypointFollower> make(const WaypointFollowerConfig& config);

  Status set_path(std::span<const geometry::Pose2> path) override;
  void clear_path() override;
  double remaining() const override { return path_.remaining(); }
  Status set_pace(double pace) override;
  void set_touches(const kinematics::Whiskers& touches) override { window_.set_touches(touches); }
  /// What lies ahead; without it the robot does not drive.
  SectorMedians& sectors() { return sectors_; }

  Decision decide(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                  const geometry::Twist2& measured, const geometry::Twist2& last_command,
                  double seconds_since_last, std::span<const MovingDisc> people = {}) override;
  Decision back_off(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                    const geometry::Twist2& measured, const geometry::Twist2& last_command,
                    double seconds_since_last, double speed,
                    std::span<const MovingDisc> people = {}) override;
  Decision rotate(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                  const geometry::Twist2& measured, const geometry::Twist2& last_command,
                  double seconds_since_last, double rate,
                  std::span<const MovingDisc> people = {}) override;

 private:
  struct Input {
    const grid::Grid<std::uint8_t>& costs;
    geometry::Pose2 pose;
    geometry::Twist2 measured, last_command;
    double seconds;
  };
  WaypointFollower(const WaypointFollowerConfig& config, DynamicWindow window);

  const DynamicWindowConfig& motion() const { return config_.motion; }
  bool last_waypoint() const { return next_ + 1 == waypoints_.size(); }
  void pass_waypoints(const geometry::Point2& position);
  double turn_at_next() const;
  double obstacle_ahead() const;
  Decision halt(const Input& input, Reason reason, double deceleration) const;
  Decision turn(const Input& input, double angle, Reason reason);
  Decision at_goal(const Input& input);
  Decision drive(const Input& input, double error, double distance);

  WaypointFollowerConfig config_;
  DynamicWindow window_;
  SectorMedians sectors_;
  ReferencePath path_;
  std::vector<geometry::Point2> waypoints_;
  std::size_t next_ = 0;
  bool turning_ = true;                                // to the next waypoint
  int sense_ = 0;                                      // of a turn that has begun
  bool arrived_ = false;                               // at the last one
  double outline_ahead_ = 0.0, outline_beside_ = 0.0;  // [m] of the robot's middle
  std::vector<geometry::Pose2> way_;
};

}  // namespace usher::local_planner
