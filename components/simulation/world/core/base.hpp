#pragma once

#include "foundation/geometry/pose2.hpp"
#include "foundation/random/random.hpp"

namespace usher::world {

using geometry::Point2;
using geometry::Pose2;
using geometry::Twist2;

/// Every model of the world advances by exactly this [s].
inline constexpr double kStep = 0.01;

/// Where the robot really is: nothing on the robot may read it, only the simulator and its judges.
struct BaseTruth {
  Pose2 pose;               ///< in world, of base_footprint: the floor below the middle of the axle
  Twist2 twist;             ///< [m/s], [rad/s]
  double pitch = 0.0;       ///< [rad] positive leans forward; 0 for bases that do not lean
  double pitch_rate = 0.0;  ///< [rad/s]
};

/// What the base's own sensors say.
struct BaseReadings {
  double left_travel = 0.0;        ///< [m] rolled by the left wheel against the body since start
  double right_travel = 0.0;       ///< [m] the same of the right wheel
  double left_velocity = 0.0;      ///< [m/s] by the encoders
  double right_velocity = 0.0;     ///< [m/s]
  double yaw_rate = 0.0;           ///< [rad/s] gyroscope
  double pitch = 0.0;              ///< [rad] positive leans forward
  double pitch_rate = 0.0;         ///< [rad/s]
  double battery_percent = 100.0;  ///< [%] {0..100}
  bool motors_on = true;           ///< false from an emergency stop until the base stands again
  bool emergency = false;          ///< latched from emergency_stop() to reset()

  double travel() const { return 0.5 * (left_travel + right_travel); }        ///< [m] of the middle
  double velocity() const { return 0.5 * (left_velocity + right_velocity); }  ///< [m/s]
};

/// A mobile base: takes velocity commands, moves in the world, reports what its encoders measure.
/// Deterministic for its seed. A command that is not repeated within the base's time-out is taken
/// as zero.
class Base {
 public:
  virtual ~Base() = default;

  /// Puts the base somewhere, standing still; the encoders keep their counts.
  virtual void place(const Pose2& pose) = 0;
  /// The wanted twist; values that are not finite are ignored.
  virtual void command(const Twist2& twist) = 0;
  /// Motors off, latched: commands are ignored until reset().
  virtual void emergency_stop() = 0;
  /// Clears the latch; the base obeys again once it stands still and upright.
  virtual void reset() = 0;
  /// Advances by kStep.
  virtual void step() = 0;
  /// Something solid stopped the base at `pose`: the speed is lost, the wheels slip (encoders keep
  /// counting).
  virtual void obstruct(const Pose2& pose) = 0;

  const BaseTruth& truth() const { return truth_; }
  const BaseReadings& readings() const { return readings_; }

 protected:
  /// How the wheels of one kind of base tell distance and turns; drawn once for a robot's life.
  struct Encoders {
    double track = 0.47;          ///< [m] between the wheels
    double distance_scale = 1.0;  ///< measured over real
    double turn_scale = 1.0;      ///< measured over real
    double curl = 0.0;            ///< [rad/m] measured turn of a straight way: unequal wheels
    double slip = 0.0;            ///< [m/sqrt(m)] noise of each wheel
  };
  /// Adds what the encoders see of one step: `distance` [m] rolled, `turned` [rad].
  void count_wheels(const Encoders& encoders, double distance, double turned, Random& random);
  /// One step's use of the battery, which lasts `hours` standing and half of that at 1 m/s.
  void drain_battery(double hours);

  BaseTruth truth_;
  BaseReadings readings_;
};

}  // namespace usher::world
