#pragma once

#include <optional>
#include <span>

#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/stopping_distance.hpp"

namespace usher::movement_control {

/// Keeps who does not look ahead himself, an operator or somebody who turns the robot, from driving
/// into what the laser sees: the robot is told to move no faster than it can stop before it, along
/// the arc that it is told to drive, corners included.
///
/// A motion (v, w) is scaled by one factor, so that the arc stays. With c the time until the
/// outline, wider by `margin`, meets something,
///
///     d(|v|) <= |v| c - reaction |v_measured|,      turn_stop |w| <= |w| c - turn_reaction
///     |w_measured|
///
/// where d is the base's measured stopping distance. Within the margin, where measurements are no
/// better, it still creeps, by the same rule for half of the margin. One point alone may be noise:
/// the second one counts.
class Guard {
 public:
  struct Parameters {
    geometry::Footprint outline = geometry::Footprint::rectangle(0.61, 0.66);
    kinematics::StoppingDistance stopping;
    double turn_stop = 0.3;  ///< [s] {> 0} of a turn rate: the turn after it is told to end
    double reaction = 0.7;   ///< [s] {>= 0} from a measurement until a falling command is followed
    double turn_reaction = 0.2;  ///< [s] {>= 0} likewise when turning
    double margin = 0.02;        ///< [m] {>= 0} of the laser's error
    double creep = 0.05;         ///< [m/s] {>= 0} of the outline's fastest point, within the margin
    double blind = 0.1;          ///< [m/s] {>= 0} likewise, where nothing is seen
  };

  explicit Guard(const Parameters& parameters);

  /// What is around, in base_footprint.
  struct View {
    std::span<const geometry::Point2> points;
    bool sees = false;  ///< a scan tells what is ahead; else there may be more than these points
  };

  /// The share {0..1} of a motion that is allowed.
  double share(const geometry::Twist2& twist, const View& view,
               const std::optional<geometry::Twist2>& measured) const;

  /// Told to stand, a robot that moves so, and goes on to, comes to rest before it meets something.
  bool stops(const geometry::Twist2& twist, std::span<const geometry::Point2> points) const;

  /// [m] The way along the arc of `twist`, standing or turning the way straight ahead, until the
  /// outline meets something: infinity where it does not.
  double way(const geometry::Twist2& twist, std::span<const geometry::Point2> points) const;

 private:
  double creeping(const geometry::Twist2& twist, double speed) const;
  double stoppable(const geometry::Twist2& twist, double contact,
                   const geometry::Twist2& measured) const;

  Parameters parameters_;
  geometry::Footprint wide_, narrow_;
};

}  // namespace usher::movement_control
