#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/kinematics/acceleration_limiter.hpp"
#include "navigation/local_planner/core/contact.hpp"

namespace usher::local_planner {

/// Something that moves at a constant velocity, a person for example; in the frame of the cost
/// grid, which may hold the place where it is now as well.
struct MovingDisc {
  geometry::Point2 position{0.0, 0.0};
  geometry::Point2 velocity{0.0, 0.0};  ///< [m/s]
  double radius = 0.0;                  ///< [m]
};

/// How the base answers a command: after `latency` it follows as a first-order lag with a bounded
/// acceleration.
struct BaseResponse {
  double latency = 0.05;              ///< [s] from the command to the first change
  double time_constant = 0.5;         ///< [s] of the speed
  double turn_time_constant = 0.2;    ///< [s] of the turn rate
  double acceleration = 1.0;          ///< [m/s2] that the base reaches
  double angular_acceleration = 3.0;  ///< [rad/s2]
};

/// The state that every trajectory of a cycle starts from.
struct RolloutStart {
  geometry::Pose2 pose;
  geometry::Twist2 measured;
  geometry::Twist2 last_command;  ///< in flight: the base still follows it during the latency
};

/// A speed over time on the way to a target command: step k is at k * dt.
struct SpeedProfile {
  double target = 0.0;
  int contact = 0;             ///< which of the contact tests holds at this speed (speeds only)
  double needed = 0.0;         ///< [m] way that must be free of contact
  int steps = 0;               ///< simulated, at most Rollout::kMostSteps
  std::vector<double> values;  ///< [m/s] or [rad/s], steps + 1
  std::vector<double> way;     ///< [m] travelled up to each step (speeds only)
};

/// How a command is ramped and how the base follows it, for speed or turn rate.
struct Ramp {
  double rise = 0.0, fall = 0.0;  ///< per second, of the command's magnitude
  double latency = 0.0;           ///< [s]
  double time_constant = 0.0;     ///< [s]
  double acceleration = 0.0;      ///< per second, that the base reaches
};

/// One simulated trajectory.
struct Trajectory {
  int speed = 0;       ///< index of the speed profile
  int turn = 0;        ///< index of the turn profile
  int free_steps = 0;  ///< steps before the first contact
  bool contact = false;
  bool disc = false;        ///< the contact is one with a moving disc
  bool admissible = false;  ///< free for as far as its speed needs to stop
  float close = 0.0F;       ///< share of its steps where only the narrower test was free, 0..1
  float mean_cost = 0.0F;   ///< of the cells below the base's origin, 0..1
  float disc_cost =
      0.0F;  ///< 1 where it brushes past a moving disc, 0 beyond the comfortable distance
};

/// The tests that a speed chooses from, the narrower first: faster needs more room.
using ContactTests = std::array<const ContactTest*, 2>;

/// Simulates every combination of speed and turn profiles from one start and tests each for
/// contact. Turning does not depend on the speed, so directions and turned footprints are computed
/// once per turn profile and step.
class Rollout {
 public:
  static constexpr int kMostSteps = 63;

  struct Settings {
    double step = 0.085;  ///< [s]
    int scored_steps =
        20;  ///< what is looked at for the scores; the stopping way may reach further
    bool unknown_is_lethal = false;
    double disc_clearance =
        0.2;  ///< [m] kept from a moving disc at speeds that need more room, a quarter below
    double comfortable = 0.5;  ///< [m] from a moving disc
  };

  Rollout(const Settings& settings, cpu::Simd simd) : settings_(settings), simd_(simd) {}

  /// The speed (or turn rate) over time for a target command: the command is ramped from the one in
  /// flight, the base follows with its lag. At least `steps` steps, more until the way reaches
  /// profile.needed.
  void profile(double now, double in_flight, double target, const Ramp& ramp, int steps,
               SpeedProfile& profile) const;

  /// All combinations; `trajectories` is ordered by turn, then speed. Points of scored steps are
  /// kept for scoring.
  void run(const RolloutStart& start, std::span<const SpeedProfile> speeds,
           std::span<const SpeedProfile> turns, const grid::Grid<std::uint8_t>& costs,
           const LethalBits& bits, const ContactTests& contacts, const Footprint& footprint,
           std::span<const MovingDisc> discs);

  std::span<const Trajectory> trajectories() const { return trajectories_; }
  /// Positions relative to the start [m] and directions at three of the scored steps (a third, two
  /// thirds, the end, at most the last free one): index 3 * trajectory + part.
  std::span<const float> x() const { return x_; }
  std::span<const float> y() const { return y_; }
  std::span<const float> end_cosine() const { return end_cosine_; }  ///< per trajectory
  std::span<const float> end_sine() const { return end_sine_; }

  /// Poses of one trajectory, step 0 to its last free scored step.
  void poses(const RolloutStart& start, const SpeedProfile& speed, const SpeedProfile& turn,
             int steps, std::vector<geometry::Pose2>& poses) const;

  const Settings& settings() const { return settings_; }

 private:
  struct Frame;
  void directions(double yaw, const SpeedProfile& turn);
  void simulate(const Frame& frame, const SpeedProfile& speed, std::size_t index);
  bool touches(const Frame& frame, double x, double y, int step, int contact);
  bool meets_disc(const Frame& frame, double x, double y, int step, int contact,
                  float& brush) const;

  Settings settings_;
  cpu::Simd simd_;
  std::vector<Trajectory> trajectories_;
  std::vector<float> x_, y_, end_cosine_, end_sine_;
  double cosine_[kMostSteps + 1] = {};
  double sine_[kMostSteps + 1] = {};
  // Per contact test: the footprint turned to the steps of the current turn profile, and which
  // steps have it.
  std::array<std::uint64_t, 2> turned_ready_ = {};
  std::array<std::vector<TurnedFootprint>, 2> turned_;
};

}  // namespace usher::local_planner
