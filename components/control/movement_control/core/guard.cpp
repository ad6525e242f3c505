#include "control/movement_control/core/guard.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "foundation/geometry/swept_outline.hpp"
#include "foundation/kinematics/roll_out.hpp"

namespace usher::movement_control {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// [s] until the second of the points is met; farther than `reach` [m] away nothing counts.
double second_contact(const geometry::Footprint& outline, const geometry::Twist2& twist,
                      std::span<const geometry::Point2> points, double reach = kNever) {
  const geometry::SweptOutline swept(outline, twist);
  double first = kNever, second = kNever;
  for (const geometry::Point2& point : points) {
    if (point.squaredNorm() > reach * reach) continue;
    const double contact = swept.contact(point);
    second = std::min(second, std::max(first, contact));
    first = std::min(first, contact);
  }
  return second;
}

/// The part of a measured speed that goes the way that is wanted.
double along(double measured, double wanted) {
  return measured * wanted > 0.0 ? std::abs(measured) : 0.0;
}

}  // namespace

Guard::Guard(const Parameters& parameters)
    : parameters_(parameters),
      wide_(parameters.outline.grown(parameters.margin)),
      narrow_(parameters.outline.grown(0.5 * parameters.margin)) {
  assert(parameters.turn_stop > 0.0 && parameters.reaction >= 0.0 && parameters.margin >= 0.0 &&
         parameters.stand_off >= 0.0);
}

double Guard::creeping(const geometry::Twist2& twist, double speed) const {
  const double fastest =
      std::abs(twist.v) + std::abs(twist.w) * parameters_.outline.circumscribed_radius();
  return fastest > speed ? speed / fastest : 1.0;
}

/// The share from which the robot stops in time. On the spot the corners keep the stand-off.
double Guard::stoppable(const geometry::Twist2& twist, double contact,
                        const geometry::Twist2& measured, double stand_off) const {
  if (contact == kNever) return 1.0;
  double share = 1.0;
  if (twist.v != 0.0) {
    const double gone = parameters_.reaction * along(measured.v, twist.v);
    const double room = std::abs(twist.v) * contact - stand_off - gone;
    share = std::min(share, parameters_.stopping.speed(room) / std::abs(twist.v));
  }
  if (twist.w != 0.0) {
    const double gone = parameters_.turn_reaction * along(measured.w, twist.w);
    const double left =
        twist.v == 0.0 ? stand_off / parameters_.outline.circumscribed_radius() : 0.0;
    const double room = std::abs(twist.w) * contact - left - gone;
    share = std::min(share, std::max(0.0, room) / (parameters_.turn_stop * std::abs(twist.w)));
  }
  return share;
}

/// Likewise, with the stand-off and no slower than it may be there.
double Guard::kept_off(const geometry::Twist2& twist, double contact,
                       const geometry::Twist2& measured) const {
  const double share = stoppable(twist, contact, measured, parameters_.stand_off);
  return share < creeping(twist, parameters_.slowest) ? 0.0 : share;
}

/// [m] What is farther from the axle's middle allows the whole motion.
double Guard::farthest(const geometry::Twist2& twist, const geometry::Twist2& measured) const {
  const double v = std::abs(twist.v), w = std::abs(twist.w);
  double way = parameters_.stopping.distance(v) + parameters_.stand_off +
               parameters_.reaction * along(measured.v, twist.v);
  if (w > 0.0) {
    const double turn =
        parameters_.turn_stop * w + parameters_.turn_reaction * along(measured.w, twist.w);
    way = std::max(way, v * turn / w);
  }
  return wide_.circumscribed_radius() + way;
}

double Guard::reach(double speed) const {
  return wide_.circumscribed_radius() + parameters_.stopping.distance(speed) +
         parameters_.stand_off + parameters_.reaction * std::abs(speed);
}

double Guard::share(const geometry::Twist2& twist, const View& view,
                    const std::optional<geometry::Twist2>& measured) const {
  if (twist == geometry::Twist2{}) return 1.0;
  const geometry::Twist2 moves = measured.value_or(twist);
  const double reach = farthest(twist, moves);
  const double cells =
      kept_off(twist, second_contact(parameters_.outline, twist, view.cells, reach), moves);
  const double most = std::min(cells, view.sees ? 1.0 : creeping(twist, parameters_.blind));
  const double wide = std::min(
      most, stoppable(twist, second_contact(wide_, twist, view.points, reach), moves, 0.0));
  const double creep = std::min(most, creeping(twist, parameters_.creep));
  if (wide >= creep) return wide;
  return std::max(
      wide, std::min(creep, stoppable(twist, second_contact(narrow_, twist, view.points, reach),
                                      moves, 0.0)));
}

double Guard::planned_share(const geometry::Twist2& twist, const View& view,
                            const std::optional<geometry::Twist2>& measured) const {
  const geometry::Twist2 moves = measured.value_or(twist);
  const bool rolls = std::abs(moves.v) >= kinematics::RollOut::kStanding;
  if (twist == geometry::Twist2{} || (twist.v == 0.0 && rolls)) return 1.0;
  const double reach = farthest(twist, moves);
  const double contact =
      std::min(second_contact(parameters_.outline, twist, seen(view).points, reach),
               second_contact(parameters_.outline, twist, view.cells, reach));
  const bool in_time = twist.v != 0.0 ? parameters_.stopping.distance(std::abs(twist.v)) <=
                                            std::abs(twist.v) * contact - parameters_.stand_off
                                      : parameters_.turn_stop <= contact;
  return in_time ? 1.0 : kept_off(twist, contact, moves);
}

bool Guard::stops(const geometry::Twist2& twist, const View& view) const {
  const double contact = std::min(second_contact(wide_, twist, view.points),
                                  second_contact(parameters_.outline, twist, view.cells));
  return contact == kNever ||
         parameters_.stopping.distance(std::abs(twist.v)) <= std::abs(twist.v) * contact;
}

double Guard::way(const geometry::Twist2& twist, const View& view) const {
  const geometry::Twist2 driven = twist.v == 0.0 ? geometry::Twist2{1.0, 0.0} : twist;
  return std::abs(driven.v) * std::min(second_contact(parameters_.outline, driven, view.points),
                                       second_contact(parameters_.outline, driven, view.cells));
}

}  // namespace usher::movement_control
