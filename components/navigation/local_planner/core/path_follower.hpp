#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/kinematics/whisker_reflex.hpp"
#include "foundation/result/result.hpp"
#include "navigation/local_planner/core/rollout.hpp"

namespace usher::local_planner {

enum class Reason : std::uint8_t {
  kFollowing,      ///< drives along the path
  kTight,          ///< drives slowly where only its own outline fits
  kTurning,        ///< turns in place towards the path
  kTurningToGoal,  ///< stands at the goal, turns to its yaw
  kReached,        ///< at the goal; the command is zero
  kBraking,        ///< no trajectory can be stopped before an obstacle: stops
  kBlocked,        ///< stands before an obstacle
  kGivingWay,      ///< stands before somebody, who may pass
  kTouching,       ///< stands with a lethal cell inside its outline: a recovery motion may free it
  kRecovering,     ///< a recovery motion runs
  kNoPath,         ///< nothing to follow
  kInvalidInput,   ///< not finite, an empty grid, or a robot outside of it; the command is zero
};
const char* to_string(Reason reason);

/// Contribution of each critic to the winner, weighted; smaller is better.
struct CriticScores {
  double path = 0.0, goal = 0.0, alignment = 0.0, goal_front = 0.0, obstacle = 0.0,
         moving_obstacle = 0.0, speed = 0.0, twirling = 0.0, smoothness = 0.0, oscillation = 0.0;
  double total() const {
    return path + goal + alignment + goal_front + obstacle + moving_obstacle + speed + twirling +
           smoothness + oscillation;
  }
};

struct Decision {
  geometry::Twist2 command;  ///< to send now; ramped from the last command
  Reason reason = Reason::kNoPath;
  bool blocked = false;  ///< no motion along the path is possible; the command goes to zero
  bool reached = false;  ///< position and yaw within tolerance, standing
  /// Along the path from the base to where the footprint first meets a lethal cell [m]; infinite
  /// when there is none in sight.
  double obstacle_distance = std::numeric_limits<double>::infinity();
  geometry::Twist2 target;  ///< of the winning trajectory
  CriticScores scores;
  int trajectories = 0;  ///< simulated
  int admissible = 0;
  std::span<const geometry::Pose2> trajectory;  ///< the winner; valid until the next call
};

/// Drives along a path, one decision a control cycle; grid, path, poses and people are in one frame
/// (odom). The dynamic window, or the waypoint follower.
class PathFollower {
 public:
  virtual ~PathFollower() = default;

  /// 1 to 100000 finite poses; the last is the goal with its yaw. An error leaves the old path.
  virtual Status set_path(std::span<const geometry::Pose2> path) = 0;
  virtual void clear_path() = 0;
  virtual double remaining() const = 0;  ///< [m] of the path
  /// The speed to keep from now on [m/s]; what the base does not follow is refused.
  virtual Status set_pace(double pace) = 0;
  /// What the corners touch from now on.
  virtual void set_touches(const kinematics::Whiskers& touches) = 0;

  virtual Decision decide(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                          const geometry::Twist2& measured, const geometry::Twist2& last_command,
                          double seconds_since_last, std::span<const MovingDisc> people) = 0;
  /// Recovery: backward at `speed` [m/s, positive].
  virtual Decision back_off(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                            const geometry::Twist2& measured, const geometry::Twist2& last_command,
                            double seconds_since_last, double speed,
                            std::span<const MovingDisc> people) = 0;
  /// Recovery: turns in place at `rate` [rad/s, either sign].
  virtual Decision rotate(const grid::Grid<std::uint8_t>& costs, const geometry::Pose2& pose,
                          const geometry::Twist2& measured, const geometry::Twist2& last_command,
                          double seconds_since_last, double rate,
                          std::span<const MovingDisc> people) = 0;
};

}  // namespace usher::local_planner
