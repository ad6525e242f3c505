#pragma once

#include <optional>
#include <span>
#include <utility>

#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/stopping_distance.hpp"

namespace usher::movement_control {

/// Keeps the robot from driving into what the laser sees and what the local costs know: it is told
/// to move no faster than it can stop before that, along the arc that it is told to drive, corners
/// included.
///
/// A motion (v, w) is scaled by one factor, so that the arc stays. With c the time until the
/// outline meets something,
///
///     d(|v|) <= |v| c - stand_off - reaction |v_measured|
///     turn_stop |w| <= |w| c - turn_reaction |w_measured|
///
/// where d is the base's measured stopping distance. One point alone may be noise: the second one
/// counts, and likewise of the cells, each of which one such point may have made.
///
///  - Who does not look ahead himself, an operator or somebody who turns the robot, keeps the
///    outline wider by `margin` off what the laser sees, without a stand-off. Within the margin,
///    where measurements are no better, the robot still creeps, by the same rule for half of the
///    margin. Off lethal cells the bare outline keeps the stand-off.
///  - A planner looks ahead itself, also along ways that are no arcs: it is left alone as long as
///    the robot, told to stand, comes to rest in time, d(|v|) <= |v| c - stand_off, with the bare
///    outline and before what was seen; what it is told beyond that is scaled as above.
///
/// Where a stand-off is kept, a motion that may be no faster than `slowest` is none: the robot
/// would creep so near that it heard no glass any more, and the costs forgot it.
class Guard {
 public:
  struct Parameters {
    geometry::Footprint outline = geometry::Footprint::rectangle(0.61, 0.66);
    kinematics::StoppingDistance stopping;
    double turn_stop = 0.3;  ///< [s] {> 0} of a turn rate: the turn after it is told to end
    double reaction = 0.7;   ///< [s] {>= 0} from a measurement until a falling command is followed
    double turn_reaction = 0.2;  ///< [s] {>= 0} likewise when turning
    double margin = 0.02;        ///< [m] {>= 0} of the laser's error
    double stand_off = 0.08;     ///< [m] {>= 0} of the way ahead; what is in a cell may be nearer
    double slowest = 0.15;       ///< [m/s] {>= 0} of the outline, where the stand-off is kept
    double creep = 0.05;         ///< [m/s] {>= 0} of the outline's fastest point, within the margin
    double blind = 0.1;          ///< [m/s] {>= 0} likewise, where nothing is seen
  };

  explicit Guard(const Parameters& parameters);

  /// What is around, in base_footprint.
  struct View {
    std::span<const geometry::Point2> points;  ///< of the laser
    bool sees = false;  ///< a scan tells what is ahead; else there may be more than these points
    std::size_t guessed = 0;                  ///< so many of them, the last, nobody has seen
    std::span<const geometry::Point2> cells;  ///< centers of lethal cells of the local costs
  };
  /// Without what is guessed.
  static View seen(View view) {
    view.points = view.points.first(view.points.size() - std::exchange(view.guessed, 0));
    return view;
  }

  /// The share {0..1} of a motion at which no point of the outline is faster than `speed` [m/s].
  double creeping(const geometry::Twist2& twist, double speed) const;
  /// The share {0..1} of a motion that is allowed to who does not look ahead.
  double share(const geometry::Twist2& twist, const View& view,
               const std::optional<geometry::Twist2>& measured) const;
  /// Likewise to a planner. One who turns only while the robot rolls has told it to stand, and
  /// keeps it on its arc: 1.
  double planned_share(const geometry::Twist2& twist, const View& view,
                       const std::optional<geometry::Twist2>& measured) const;

  /// [m] {> 0} from the axle's middle: so far cells bar the way of a robot that is no faster [m/s].
  double reach(double speed) const;

  /// Told to stand, a robot that moves so, and goes on to, comes to rest before it meets something.
  bool stops(const geometry::Twist2& twist, const View& view) const;

  /// [m] The way along the arc of `twist`, standing or turning the way straight ahead, until the
  /// outline meets something: infinity where it does not.
  double way(const geometry::Twist2& twist, const View& view) const;

 private:
  double stoppable(const geometry::Twist2& twist, double contact, const geometry::Twist2& measured,
                   double stand_off) const;
  double kept_off(const geometry::Twist2& twist, double contact,
                  const geometry::Twist2& measured) const;
  double farthest(const geometry::Twist2& twist, const geometry::Twist2& measured) const;

  Parameters parameters_;
  geometry::Footprint wide_, narrow_;
};

}  // namespace usher::movement_control
