#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "control/movement_control/core/guard.hpp"
#include "control/movement_control/core/situation.hpp"
#include "drivers/base_obedience/core/response_watch.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/kinematics/roll_out.hpp"
#include "foundation/kinematics/whisker_reflex.hpp"
#include "foundation/kinematics/whisker_rods.hpp"

namespace usher::movement_control {

using kinematics::Whiskers;

/// Who is driving. The numbers are those of MovementStatus on the wire.
enum class Source : std::uint8_t { kNone = 0, kManual = 1, kInteraction = 2, kNavigation = 3 };

/// How far the pose can be trusted. The zero is the safe one, as on the wire.
enum class Localization : std::uint8_t { kLost = 0, kDegraded = 1, kGood = 2 };

/// What the supervisor allows (table 6.1 of the thesis).
struct Enables {
  bool movement = false;  ///< anything but zero may be passed
  bool manual = false;
  bool interaction = false;
  bool navigation = false;
  double speed_factor = 1.0;  ///< {0..1} on all velocity limits
};

struct VelocityLimit {
  double linear = 0.0;   ///< [m/s] {>= 0}
  double angular = 0.0;  ///< [rad/s] {>= 0}
};

/// How fast the commanded velocity may change; 0 means at once.
struct AccelerationLimit {
  double speed_up = 0.0;   ///< [m/s^2] or [rad/s^2] away from zero
  double slow_down = 0.0;  ///< toward a smaller speed that is not zero
  double stop = 0.0;       ///< toward zero
};

struct Parameters {
  bool guarded = false;  ///< all sources
  Guard::Parameters guard;
  VelocityLimit obeyed{1.5, 1.5};  ///< {> 0} the base refuses more
  // The thesis, section 8.1.3 and 6.1.
  VelocityLimit open{1.4, 1.0};
  VelocityLimit corridor{1.0, 1.0};
  VelocityLimit confined{0.8, 1.0};
  VelocityLimit person_ahead{1.0, 0.5};
  // Ours.
  VelocityLimit localization_degraded{0.5, 0.6};
  VelocityLimit localization_lost{0.0, 0.5};  ///< navigation only; turning may find the pose again
  VelocityLimit low_battery{0.8, 0.6};
  double reverse = 0.4;  ///< [m/s] {>= 0} nothing sees behind
  double touched = 0.1;  ///< [m/s] {>= 0} creeping past what a whisker touches
  kinematics::WhiskerMount whiskers;
  /// [m/s] {> 0} Guard and reflex tell a base that rolls to be no more than this slower than it is:
  /// a balancing one that is told to drop by more holds its speed first, to lean back.
  double largest_drop = 5.0;

  /// The Segway's own acceleration; a stop passes at once, as the stopping distances were measured.
  AccelerationLimit linear{0.7, 1.4, 0.0};
  AccelerationLimit angular{1.5, 3.0, 0.0};
  /// [m/s^3] [rad/s^3] {>= 0, 0 = at once} How fast these accelerations build up and fade for an
  /// operator and the interaction; with a linear one they turn back only when the base stands. A
  /// stop is not delayed.
  geometry::Twist2 jerk;
  /// A longer pause between two decisions counts as this one for the acceleration. {> 0}
  Time longest_step = std::chrono::milliseconds(40);

  bool whiskers_required = true;  ///< without fresh whiskers nothing moves
  drive::ResponseWatch::Parameters response;
};

/// All that a decision depends on. Absence means that nothing fresh is known, and is always the
/// careful case.
struct Inputs {
  std::optional<Enables> enables;          ///< absent: nothing is enabled
  std::optional<geometry::Twist2> manual;  ///< fresh commands of the three sources
  std::optional<geometry::Twist2> interaction;
  std::optional<geometry::Twist2> navigation;
  std::optional<Whiskers> whiskers;
  std::optional<bool> person_ahead;  ///< absent: as if there were one
  Situation situation = Situation::kConfined;
  Localization localization = Localization::kLost;
  bool low_battery = false;
  Guard::View view;  ///< living through the decision; its cells know the map, so none when lost
  /// Where people are or were lately, in base_footprint, living through the decision; absent:
  /// nobody tells, and whatever the costs know may be somebody.
  std::optional<std::span<const geometry::Point2>> people;
  std::optional<geometry::Twist2> measured;  ///< absent: the base is not connected
  bool motors_off = false;                   ///< after an emergency stop: it keeps no arc
};

/// What bounds the velocity or stops the robot now, the strictest one.
enum class Limit : std::uint8_t {
  kNone,
  kNotEnabled,  ///< the supervisor allows nothing, or is silent
  kNoCommand,   ///< no enabled source has a fresh command
  kNotFinite,   ///< the driving source sent NaN or infinity
  kNoBase,      ///< the base's status is missing
  kNoWhiskers,  ///< the whiskers are required and missing
  kWhisker,     ///< a touched corner bars this motion
  kLocalizationLost,
  kLocalizationDegraded,
  kLowBattery,
  kPersonAhead,
  kSpeedFactor,  ///< something is degraded, says the supervisor
  kSituation,
  kReverse,
  kObstacle,  ///< it could not stop before what is seen or known to be there
  kBlind,     ///< no scan tells what is ahead
  kAcceleration,
};

/// Words for an operator; empty for kNone.
std::string_view text(Limit limit);

/// Appendix A.1 of the thesis, without its topic and frame names.
struct MovementStatus {
  Enables enables;
  VelocityLimit max_human;
  VelocityLimit max_normal;
  drive::ResponseWatch::Axis threshold_linear;
  drive::ResponseWatch::Axis threshold_angular;
  VelocityLimit max_current;  ///< in force now
  geometry::Twist2 current;   ///< commanded now
  geometry::Twist2 measured;  ///< zero when unknown
  drive::ResponseWatch::AxisError error_linear;
  drive::ResponseWatch::AxisError error_angular;
  Whiskers whiskers;  ///< none pressed when unknown
  bool base_connected = false;
  bool ok = false;                ///< all that is needed to drive is there
  Source source = Source::kNone;  ///< who drives
  Situation situation = Situation::kConfined;
  Limit limit = Limit::kNotEnabled;  ///< the strictest limit that bears on the command
};

struct Decision {
  geometry::Twist2 twist;  ///< what to command; always finite
  Source source = Source::kNone;
  Limit limit = Limit::kNotEnabled;
};

/// Chooses among the three sources by priority and bounds what they want.
///
/// In this order: the highest enabled source with a fresh command; velocity limits of the
/// situation, of a person ahead, of localization, battery and supervisor, by one factor so that the
/// driven arc stays; the guard, which leaves a navigation alone that has not gone wrong;
/// acceleration limits; for an operator and the interaction the guard again, because while the
/// robot speeds up into a turn its arc is another one; whisker reflex. Anything missing gives zero
/// (with the turn rate that keeps a rolling base on its arc), and zero is a decision too: it is to
/// be published, silence is not.
///
/// Call it whenever a command arrives and at the timer; the acceleration limits use the time since
/// the last call. Deterministic, no allocation.
class MovementControl {
 public:
  MovementControl();
  explicit MovementControl(const Parameters& parameters);

  Decision decide(const Inputs& inputs, Time now);

  /// About the last decision.
  const MovementStatus& status() const { return status_; }

  /// How often a source with the right to drive sent something that is not finite.
  std::uint64_t rejected() const { return rejected_; }
  /// How often the guard began to hold back the navigation.
  std::uint64_t held_back() const { return held_back_; }

  const Guard& guard() const { return guard_; }
  /// [m] {> 0} from the axle's middle: so far cells count for a robot that is no faster [m/s].
  double reach(double speed) const { return std::max(guard_.reach(speed), rods_.reach()); }

 private:
  struct Wish {
    Source source = Source::kNone;
    geometry::Twist2 twist;
    Limit limit = Limit::kNone;
  };
  struct Bound {
    VelocityLimit limit;
    Limit linear_by = Limit::kSituation;
    Limit angular_by = Limit::kSituation;
  };
  struct Limited {
    geometry::Twist2 twist;
    double factor = 1.0;  ///< of the wish; a base that is faster keeps more of its turn
    Limit by = Limit::kNone;
  };

  Wish choose(const Inputs& inputs) const;
  Bound bound(const Inputs& inputs, const Wish& wish) const;
  geometry::Twist2 ramp(const geometry::Twist2& wanted, Source source, Time now);
  bool smooth(Source source) const;
  static bool stands(const Wish& wish);
  bool guards(Source source) const;
  bool blind(const Wish& wish, const Inputs& inputs) const;
  double planned_share(const geometry::Twist2& twist, const Inputs& inputs, Source source);
  double turn_while_rolling(const geometry::Twist2& ramped, const Inputs& inputs, Time now);
  double turn(const Wish& wish, double part, double most, const Inputs& inputs) const;
  bool turns_into_something(double turn, const Inputs& inputs) const;
  bool only_straight_stops(double turn, const Inputs& inputs) const;
  Limited limited(const Wish& wish, const Bound& bound, const Inputs& inputs) const;
  void drive(const Wish& wish, const Inputs& inputs, Time now, Bound& bound, Decision& decision);
  double slowed(double cut, double before, const Inputs& inputs) const;
  bool turns_beside_what_is_known(const geometry::Twist2& ramped, const Inputs& inputs);
  Whiskers known(const Inputs& inputs);
  bool presses(const geometry::Twist2& measured, Time now);
  bool bent_into_something(const geometry::Twist2& bent, const geometry::Twist2& ramped,
                           const Inputs& inputs) const;
  geometry::Twist2 reflex(const geometry::Twist2& ramped, const Inputs& inputs, Time now);
  void report(const Inputs& inputs, const Decision& decision, const Bound& bound, Time now);

  Parameters parameters_;
  Guard guard_;
  kinematics::WhiskerRods rods_;
  std::vector<geometry::Point2> nobodys_;  // lethal cells at the whiskers that are no person's
  std::optional<Time> turned_at_;          ///< last, as it was told, beside what it touches
  bool pressed_ = false;                   ///< until the touch ends
  drive::ResponseWatch watch_;
  kinematics::RollOut roll_out_;
  kinematics::RollOut kept_arc_;  ///< of a source that wants to be slower
  double kept_turn_ = 0.0;        ///< [rad/s] of a planner's, now
  geometry::Twist2 last_;
  double direction_ = 0.0;         ///< [m/s] the last velocity that was not zero
  geometry::Twist2 acceleration_;  ///< [m/s^2] [rad/s^2] of the command
  std::optional<Time> last_at_;
  std::uint64_t rejected_ = 0;
  std::uint64_t held_back_ = 0;
  bool holds_back_ = false;
  MovementStatus status_;
};

}  // namespace usher::movement_control
