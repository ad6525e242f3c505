#include "control/movement_control/core/movement_control.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace usher::movement_control {

namespace {

constexpr std::size_t kMostCells = 4096;  // as lethal_cells tells

/// The next value on the way from `from` to `to`, through zero when the sign changes. With a jerk
/// the acceleration, which is kept in `acceleration`, builds up and fades no faster; a change of
/// mind and a stop are not delayed by what was wanted before.
double approach(double from, double to, const AccelerationLimit& limit, double jerk, double seconds,
                double& acceleration) {
  if (from == to || from * to < 0.0 || to == 0.0) acceleration = 0.0;
  if (from == to) return to;
  const bool through_zero = from * to < 0.0;
  const double goal = through_zero ? 0.0 : to;
  double rate = std::abs(goal) > std::abs(from) ? limit.speed_up
                : goal == 0.0                   ? limit.stop
                                                : limit.slow_down;
  if (rate == 0.0)
    return through_zero ? approach(0.0, to, limit, jerk, seconds, acceleration) : goal;
  const double way = goal - from;
  if (jerk > 0.0 && goal != 0.0) {
    if (acceleration * way < 0.0) acceleration = 0.0;
    rate = std::min(
        {rate, std::sqrt(2.0 * jerk * std::abs(way)), std::abs(acceleration) + jerk * seconds});
    acceleration = std::copysign(rate, way);
  }
  const double step = rate * seconds;
  return way > 0.0 ? std::min(from + step, goal) : std::max(from - step, goal);
}

/// Told to turn back while it still rolls the other way, a balancing base leans for both at once.
/// (One that leans to start seems to roll back, to its encoders: only who was driving turns back.)
bool rolls_against(double wanted, const std::optional<geometry::Twist2>& measured) {
  constexpr double kRolling = 0.1;  // [m/s]
  return measured && wanted * measured->v < 0.0 && std::abs(measured->v) > kRolling;
}

}  // namespace

std::string_view text(Limit limit) {
  switch (limit) {
    case Limit::kNone:
      return "";
    case Limit::kNotEnabled:
      return "movement is not enabled";
    case Limit::kNoCommand:
      return "no enabled source has a fresh command";
    case Limit::kNotFinite:
      return "the command is not finite";
    case Limit::kNoBase:
      return "the base's status is missing";
    case Limit::kNoWhiskers:
      return "the whiskers are missing";
    case Limit::kWhisker:
      return "a whisker is touched";
    case Limit::kLocalizationLost:
      return "the pose is lost";
    case Limit::kLocalizationDegraded:
      return "the pose is uncertain";
    case Limit::kLowBattery:
      return "the battery is low";
    case Limit::kPersonAhead:
      return "a person is ahead";
    case Limit::kSpeedFactor:
      return "a component is degraded";
    case Limit::kSituation:
      return "the room is limited";
    case Limit::kReverse:
      return "driving backwards unseen";
    case Limit::kObstacle:
      return "something is in the way";
    case Limit::kBlind:
      return "no scan tells what is ahead";
    case Limit::kAcceleration:
      return "accelerating";
  }
  return "unknown";
}

MovementControl::MovementControl() : MovementControl(Parameters{}) {}

MovementControl::MovementControl(const Parameters& parameters)
    : parameters_(parameters),
      guard_(parameters.guard),
      rods_(parameters.guard.outline, parameters.whiskers),
      watch_(parameters.response) {
  assert(parameters.longest_step > Time::zero() && parameters.reverse >= 0.0);
  nobodys_.reserve(kMostCells);
  status_.max_human = parameters.person_ahead;
  status_.max_normal = parameters.open;
  status_.threshold_linear = parameters.response.linear;
  status_.threshold_angular = parameters.response.angular;
}

MovementControl::Wish MovementControl::choose(const Inputs& inputs) const {
  const Enables enables = inputs.enables.value_or(Enables{});
  if (!enables.movement) return {Source::kNone, {}, Limit::kNotEnabled};
  if (!inputs.measured) return {Source::kNone, {}, Limit::kNoBase};
  if (parameters_.whiskers_required && !inputs.whiskers) {
    return {Source::kNone, {}, Limit::kNoWhiskers};
  }
  Wish wish{Source::kNone, {}, Limit::kNoCommand};
  if (enables.manual && inputs.manual) {
    wish = {Source::kManual, *inputs.manual, Limit::kNone};
  } else if (enables.interaction && inputs.interaction) {
    wish = {Source::kInteraction, *inputs.interaction, Limit::kNone};
  } else if (enables.navigation && inputs.navigation) {
    wish = {Source::kNavigation, *inputs.navigation, Limit::kNone};
  } else if (!enables.manual && !enables.interaction && !enables.navigation) {
    wish.limit = Limit::kNotEnabled;
  }
  // A source that speaks nonsense keeps its priority: nobody below it takes over by accident.
  if (!wish.twist.finite()) return {wish.source, {}, Limit::kNotFinite};
  return wish;
}

/// The planner's costs take for free what no beam tells of.
bool MovementControl::blind(const Wish& wish, const Inputs& inputs) const {
  return parameters_.guarded && wish.source == Source::kNavigation && !inputs.view.sees;
}

MovementControl::Bound MovementControl::bound(const Inputs& inputs, const Wish& wish) const {
  Bound bound;
  bound.limit = inputs.situation == Situation::kOpen       ? parameters_.open
                : inputs.situation == Situation::kCorridor ? parameters_.corridor
                                                           : parameters_.confined;
  bound.limit.linear = std::min(bound.limit.linear, parameters_.obeyed.linear);
  bound.limit.angular = std::min(bound.limit.angular, parameters_.obeyed.angular);
  const auto tighten = [&bound](const VelocityLimit& limit, Limit cause) {
    if (limit.linear < bound.limit.linear) {
      bound.limit.linear = limit.linear;
      bound.linear_by = cause;
    }
    if (limit.angular < bound.limit.angular) {
      bound.limit.angular = limit.angular;
      bound.angular_by = cause;
    }
  };
  if (wish.twist.v < 0.0) {
    tighten({parameters_.reverse, bound.limit.angular}, Limit::kReverse);
  }
  if (inputs.person_ahead.value_or(true)) tighten(parameters_.person_ahead, Limit::kPersonAhead);
  if (inputs.low_battery) tighten(parameters_.low_battery, Limit::kLowBattery);
  if (wish.source == Source::kNavigation) {
    if (inputs.localization == Localization::kDegraded) {
      tighten(parameters_.localization_degraded, Limit::kLocalizationDegraded);
    } else if (inputs.localization == Localization::kLost) {
      tighten(parameters_.localization_lost, Limit::kLocalizationLost);
    }
    if (blind(wish, inputs)) tighten({parameters_.guard.blind, bound.limit.angular}, Limit::kBlind);
  }
  const double factor = inputs.enables ? inputs.enables->speed_factor : 1.0;
  if (!(factor >= 1.0)) {  // NaN is the careful case
    const double careful = factor > 0.0 ? factor : 0.0;
    tighten({bound.limit.linear * careful, bound.limit.angular * careful}, Limit::kSpeedFactor);
  }
  return bound;
}

geometry::Twist2 MovementControl::ramp(const geometry::Twist2& wanted, Source source, Time now) {
  const Time step =
      last_at_ ? std::clamp(now - *last_at_, Time::zero(), parameters_.longest_step) : Time::zero();
  const double seconds = std::chrono::duration<double>(step).count();
  // The planner's commands are smooth already.
  const geometry::Twist2 jerk =
      source == Source::kNavigation ? geometry::Twist2{} : parameters_.jerk;
  return {approach(last_.v, wanted.v, parameters_.linear, jerk.v, seconds, acceleration_.v),
          approach(last_.w, wanted.w, parameters_.angular, jerk.w, seconds, acceleration_.w)};
}

/// Of a source whose wishes may be as sudden as they like. The planner's commands are smooth.
bool MovementControl::smooth(Source source) const {
  return parameters_.jerk.v > 0.0 && source != Source::kNavigation;
}

/// The base is to stand, or to turn on the spot.
bool MovementControl::stands(const Wish& wish) {
  return std::abs(wish.twist.v) < kinematics::RollOut::kStanding;
}

/// Who does not look ahead himself.
bool MovementControl::guards(Source source) const {
  return parameters_.guarded && source != Source::kNavigation;
}

/// Of what a planner that has gone wrong may do: one that has not is left alone.
double MovementControl::planned_share(const geometry::Twist2& twist, const Inputs& inputs,
                                      Source source) {
  const bool planned = parameters_.guarded && source == Source::kNavigation;
  const double share = planned ? guard_.planned_share(twist, inputs.view, inputs.measured) : 1.0;
  if (share < 1.0 && !holds_back_) ++held_back_;
  holds_back_ = share < 1.0;
  return share;
}

/// A base that is told to be much slower rolls on with its speed and the new turn rate, off the arc
/// that was free. Where that would lead it into something it stays on the old one.
double MovementControl::turn_while_rolling(const geometry::Twist2& ramped, const Inputs& inputs,
                                           Time now) {
  const double v = inputs.measured ? inputs.measured->v : 0.0;
  const double slower = std::max(0.0, std::abs(v) - parameters_.largest_drop);
  if (std::abs(v) < kinematics::RollOut::kStanding || ramped.v * v > slower * std::abs(v)) {
    kept_arc_.drive(ramped, now);
    return ramped.w;
  }
  const double kept = kept_arc_.stop(inputs.measured, now).w;
  return guard_.stops({v, ramped.w}, inputs.view) ? ramped.w : kept;
}

/// What a base that was told `before` is told when it must be as slow as `cut` [m/s]: as much
/// slower than it is as it can follow, never faster than before.
double MovementControl::slowed(double cut, double before, const Inputs& inputs) const {
  const double measured = inputs.measured ? inputs.measured->v : 0.0;
  const double slowest = std::min(std::abs(measured) - parameters_.largest_drop, std::abs(before));
  return measured * before > 0.0 && slowest > std::abs(cut) ? std::copysign(slowest, before) : cut;
}

/// The whiskers that lie where the laser has seen something, or where the costs know something that
/// stands: neither while the pose is in doubt, since they know the map's walls, nor near people.
Whiskers MovementControl::known(const Inputs& inputs) {
  constexpr double kPerson = 0.5;  // [m]
  const Whiskers seen = rods_.at_seen(Guard::seen(inputs.view).points);
  if (!inputs.people || inputs.localization != Localization::kGood) return seen;
  nobodys_.clear();
  for (const geometry::Point2& cell : inputs.view.cells) {
    if (nobodys_.size() == kMostCells) break;
    if (cell.norm() > rods_.reach()) continue;
    const auto near = [&](const geometry::Point2& person) {
      return (person - cell).norm() <= kPerson;
    };
    if (std::ranges::none_of(*inputs.people, near)) nobodys_.push_back(cell);
  }
  return seen | rods_.at_known(nobodys_);
}

/// A standing base turns in place, and every touch that bars the turn is of something known: the
/// guard has looked at that, with the outline's own corners. No scan has to tell what is ahead: a
/// laser before a wall across a corridor is too near to measure it.
bool MovementControl::turns_beside_what_is_known(const geometry::Twist2& ramped,
                                                 const Inputs& inputs) {
  const bool stands =
      inputs.measured && std::abs(inputs.measured->v) < kinematics::RollOut::kStanding;
  if (!parameters_.guarded || !inputs.whiskers || !stands || ramped.v != 0.0) return false;
  return !kinematics::bars_turn(kinematics::without(*inputs.whiskers, known(inputs)), ramped.w);
}

/// A base that turns by less than half of what it was told, for a second, presses a corner against
/// something that is not known.
bool MovementControl::presses(const geometry::Twist2& measured, Time now) {
  constexpr auto kPatience = std::chrono::seconds(1);
  if (!turned_at_ || std::abs(measured.w) >= 0.5 * std::abs(last_.w)) turned_at_ = now;
  pressed_ = pressed_ || now - *turned_at_ >= kPatience;
  return pressed_;
}

/// What the whiskers leave of an arc is another one, which nobody has looked at: the base would
/// meet what was seen there before it stands.
bool MovementControl::bent_into_something(const geometry::Twist2& bent,
                                          const geometry::Twist2& ramped,
                                          const Inputs& inputs) const {
  return parameters_.guarded && bent.v != 0.0 && bent.w != ramped.w &&
         guard_.way(bent, {.points = Guard::seen(inputs.view).points}) <
             parameters_.guard.stopping.distance(std::abs(bent.v));
}

/// While it rolls it keeps its arc where straight on it would meet something before it stands.
geometry::Twist2 MovementControl::reflex(const geometry::Twist2& ramped, const Inputs& inputs,
                                         Time now) {
  if (!kinematics::bars_turn(inputs.whiskers.value_or(Whiskers{}), ramped.w)) {
    turned_at_.reset();
    pressed_ = false;
  } else if (turns_beside_what_is_known(ramped, inputs) && !presses(*inputs.measured, now)) {
    const double most =
        0.5 * parameters_.touched / parameters_.guard.outline.circumscribed_radius();
    return {0.0, std::clamp(ramped.w, -most, most)};
  }
  geometry::Twist2 twist =
      kinematics::whisker_reflex(ramped, inputs.whiskers.value_or(Whiskers{}), parameters_.touched);
  if (bent_into_something(twist, ramped, inputs)) twist = {};
  twist.v = slowed(twist.v, ramped.v, inputs);
  const double measured = inputs.measured ? inputs.measured->v : 0.0;
  if (std::abs(measured) < kinematics::RollOut::kStanding || twist.w == ramped.w) return twist;
  const geometry::Twist2 straight{measured, twist.w}, arc{measured, ramped.w};
  if (!guard_.stops(straight, inputs.view) &&
      guard_.way(arc, inputs.view) > guard_.way(straight, inputs.view))
    twist.w = ramped.w;
  return twist;
}

/// The part of a wish's turn that goes with this `part` of its speed. A base that is still faster
/// than it may be, or was told to be, rolls on with its speed: so does its turn. Where it is to
/// stand, its turn is the arc that it rolls out on, as far as that is meant.
double MovementControl::turn(const Wish& wish, double part, double most,
                             const Inputs& inputs) const {
  const auto [wished_v, wished_w] = wish.twist;
  const double cut = wished_w * part;
  if (guards(wish.source)) return cut;
  if (stands(wish)) {
    if (!(kept_turn_ * wished_w > 0.0)) return cut;
    const double kept = std::min({std::abs(kept_turn_), std::abs(wished_w), most});
    return std::copysign(std::max(std::abs(cut), kept), wished_w);
  }
  const double measured = inputs.measured ? inputs.measured->v : 0.0;
  const double v = std::abs(last_.v) > std::abs(measured) ? last_.v : measured;
  if (!(v * wished_v > 0.0)) return cut;
  return std::clamp(wished_w * std::max(part, std::min(1.0, v / wished_v)), -most, most);
}

/// A base that rolls and goes on turning so meets something that was seen before it stands,
/// straight on it does not.
bool MovementControl::only_straight_stops(double turn, const Inputs& inputs) const {
  const double v = inputs.measured ? inputs.measured->v : 0.0;
  const Guard::View seen = Guard::seen(inputs.view);
  return std::abs(v) >= kinematics::RollOut::kStanding && !guard_.stops({v, turn}, seen) &&
         guard_.stops({v, 0.0}, seen);
}

/// A base that was told to stand and still rolls would meet something that was seen before it
/// stands, and sooner than straight on.
bool MovementControl::turns_into_something(double turn, const Inputs& inputs) const {
  const double v = inputs.measured ? inputs.measured->v : 0.0;
  if (std::abs(v) < kinematics::RollOut::kStanding) return false;
  const Guard::View seen = Guard::seen(inputs.view);
  const double way = guard_.way({v, turn}, seen);
  return way < parameters_.guard.stopping.distance(std::abs(v)) && way < guard_.way({v, 0.0}, seen);
}

/// What of a wish the limits leave. One factor for both, so that a slower robot drives the same
/// arc. What may not move at all is cut instead: a lost pose forbids driving but not turning.
MovementControl::Limited MovementControl::limited(const Wish& wish, const Bound& bound,
                                                  const Inputs& inputs) const {
  const auto share = [](double limit, double wanted) {
    return std::abs(wanted) > limit && limit > 0.0 ? limit / std::abs(wanted) : 1.0;
  };
  const double linear = share(bound.limit.linear, wish.twist.v);
  const double angular = share(bound.limit.angular, wish.twist.w);
  Limited is{.factor = std::min(linear, angular)};
  if (is.factor < 1.0) is.by = linear <= angular ? bound.linear_by : bound.angular_by;
  if (blind(wish, inputs)) {
    const double creeps = guard_.creeping(wish.twist, parameters_.guard.blind);
    if (creeps < is.factor) is.factor = creeps, is.by = Limit::kBlind;
  }
  is.twist = {wish.twist.v * is.factor, turn(wish, is.factor, bound.limit.angular, inputs)};
  if (bound.limit.linear == 0.0 && is.twist.v != 0.0) is.twist.v = 0.0, is.by = bound.linear_by;
  if (bound.limit.angular == 0.0 && is.twist.w != 0.0) is.twist.w = 0.0, is.by = bound.angular_by;
  return is;
}

/// A wish, by limits, guard, ramps and whiskers.
void MovementControl::drive(const Wish& wish, const Inputs& inputs, Time now, Bound& bound,
                            Decision& decision) {
  const bool rolls_out = !guards(wish.source) && stands(wish);
  kept_turn_ = rolls_out ? kept_arc_.stop(inputs.measured, now).w : 0.0;
  Limited may = limited(wish, bound, inputs);
  geometry::Twist2& wanted = may.twist;
  if (may.by != Limit::kNone) decision.limit = may.by;
  const double planned = planned_share({wanted.v, wish.twist.w * may.factor}, inputs, wish.source);
  if (planned < 1.0) {
    const double arc =
        wanted.w == 0.0 ? 0.0 : turn(wish, may.factor * planned, bound.limit.angular, inputs);
    wanted = {slowed(wanted.v * planned, wanted.v, inputs),
              only_straight_stops(arc, inputs) ? 0.0 : arc};
    decision.limit = Limit::kObstacle;
    (wish.twist.v != 0.0 ? bound.limit.linear : bound.limit.angular) =
        std::abs(wish.twist.v != 0.0 ? wanted.v : wanted.w);
  } else if (parameters_.guarded && !guards(wish.source) && wanted.v == 0.0 && wanted.w != 0.0 &&
             turns_into_something(wanted.w, inputs)) {
    wanted.w = 0.0;
    decision.limit = Limit::kObstacle;
  }

  // What is wished, so that the arc stays, and what is really commanded: while the robot speeds
  // up into a turn its arc is another one, and what appears it slows down for at once.
  const auto guard = [&](geometry::Twist2& twist) {
    if (!guards(wish.source)) return;
    const double room = guard_.share(twist, inputs.view, inputs.measured);
    if (room >= 1.0) return;
    twist = {slowed(twist.v * room, twist.v, inputs), twist.w * room};
    decision.limit = inputs.view.sees ? Limit::kObstacle : Limit::kBlind;
    if (twist.v != 0.0) bound.limit.linear = std::abs(twist.v);
    if (twist.w != 0.0) bound.limit.angular = std::abs(twist.w);
  };
  guard(wanted);
  if (smooth(wish.source) && wanted.v * direction_ < 0.0 &&
      rolls_against(wanted.v, inputs.measured))
    wanted.v = 0.0;
  geometry::Twist2 ramped = ramp(wanted, wish.source, now);
  if (planned < 1.0) {
    if (std::abs(ramped.v) > std::abs(wanted.v)) ramped.v = wanted.v;
    if (stands(wish) && std::abs(ramped.w) > std::abs(wanted.w)) ramped.w = wanted.w;
  }
  if (ramped != wanted && decision.limit == Limit::kNone) decision.limit = Limit::kAcceleration;
  const geometry::Twist2 uncut = ramped;
  guard(ramped);
  if (guards(wish.source)) ramped.w = turn_while_rolling(ramped, inputs, now);
  if (!guards(wish.source) && !rolls_out) kept_arc_.drive(ramped, now);
  decision.twist = reflex(ramped, inputs, now);
  if (decision.twist != ramped) decision.limit = Limit::kWhisker;
  // What was cut short speeds up anew.
  if (decision.twist.v != uncut.v) acceleration_.v = 0.0;
  if (decision.twist.w != uncut.w) acceleration_.w = 0.0;
  roll_out_.drive(decision.twist, now);
}

Decision MovementControl::decide(const Inputs& inputs, Time now) {
  const Wish wish = choose(inputs);
  Bound limits = bound(inputs, wish);
  Decision decision{{}, wish.source, wish.limit};
  if (wish.limit == Limit::kNotFinite) ++rejected_;
  if (wish.limit == Limit::kNone) {
    drive(wish, inputs, now, limits, decision);
  } else {
    acceleration_ = {};
    const geometry::Twist2 rolls = roll_out_.stop(inputs.measured, now);
    decision.twist = reflex(inputs.motors_off ? geometry::Twist2{} : rolls, inputs, now);
  }

  // A share of a wish may round up, and the arc that a base rolls out on be over the limit.
  const VelocityLimit& most = parameters_.obeyed;
  decision.twist = {std::clamp(decision.twist.v, -most.linear, most.linear),
                    std::clamp(decision.twist.w, -most.angular, most.angular)};
  last_ = decision.twist;
  if (last_.v != 0.0) direction_ = last_.v;
  last_at_ = now;
  report(inputs, decision, limits, now);
  return decision;
}

void MovementControl::report(const Inputs& inputs, const Decision& decision, const Bound& bound,
                             Time now) {
  if (inputs.measured) watch_.observe(decision.twist, *inputs.measured, now);
  status_.enables = inputs.enables.value_or(Enables{});
  status_.max_current = bound.limit;
  status_.current = decision.twist;
  status_.measured = inputs.measured.value_or(geometry::Twist2{});
  status_.error_linear = watch_.linear();
  status_.error_angular = watch_.angular();
  status_.whiskers = inputs.whiskers.value_or(Whiskers{});
  status_.base_connected = inputs.measured.has_value();
  status_.ok = inputs.enables && inputs.measured &&
               (inputs.whiskers || !parameters_.whiskers_required) &&
               decision.limit != Limit::kNotFinite;
  status_.source = decision.source;
  status_.situation = inputs.situation;
  status_.limit = decision.limit;
}

}  // namespace usher::movement_control
