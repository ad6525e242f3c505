#include "control/movement_control/core/guard.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "foundation/geometry/swept_outline.hpp"

namespace usher::movement_control {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// [s] until the second of the points is met.
double second_contact(const geometry::Footprint& outline, const geometry::Twist2& twist,
                      std::span<const geometry::Point2> points) {
  const geometry::SweptOutline swept(outline, twist);
  double first = kNever, second = kNever;
  for (const geometry::Point2& point : points) {
    const double contact = swept.contact(point);
    second = std::min(second, std::max(first, contact));
    first = std::min(first, contact);
  }
  return second;
}

}  // namespace

Guard::Guard(const Parameters& parameters)
    : parameters_(parameters),
      wide_(parameters.outline.grown(parameters.margin)),
      narrow_(parameters.outline.grown(0.5 * parameters.margin)) {
  assert(parameters.turn_stop > 0.0 && parameters.reaction >= 0.0 && parameters.margin >= 0.0);
}

/// The share at which no point of the outline moves faster.
double Guard::creeping(const geometry::Twist2& twist, double speed) const {
  const double fastest =
      std::abs(twist.v) + std::abs(twist.w) * parameters_.outline.circumscribed_radius();
  return fastest > speed ? speed / fastest : 1.0;
}

/// The share from which the robot stops in time.
double Guard::stoppable(const geometry::Twist2& twist, double contact,
                        const geometry::Twist2& measured) const {
  if (contact == kNever) return 1.0;
  double share = 1.0;
  if (twist.v != 0.0) {
    const double gone =
        parameters_.reaction * std::max(0.0, measured.v * twist.v) / std::abs(twist.v);
    const double room = std::abs(twist.v) * contact - gone;
    share = std::min(share, parameters_.stopping.speed(room) / std::abs(twist.v));
  }
  if (twist.w != 0.0) {
    const double gone =
        parameters_.turn_reaction * std::max(0.0, measured.w * twist.w) / std::abs(twist.w);
    const double room = std::abs(twist.w) * contact - gone;
    share = std::min(share, std::max(0.0, room) / (parameters_.turn_stop * std::abs(twist.w)));
  }
  return share;
}

double Guard::share(const geometry::Twist2& twist, const View& view,
                    const std::optional<geometry::Twist2>& measured) const {
  if (twist == geometry::Twist2{}) return 1.0;
  const geometry::Twist2 moves = measured.value_or(twist);
  const double most = view.sees ? 1.0 : creeping(twist, parameters_.blind);
  const double wide =
      std::min(most, stoppable(twist, second_contact(wide_, twist, view.points), moves));
  const double creep = creeping(twist, parameters_.creep);
  if (wide >= creep) return wide;
  return std::max(
      wide, std::min(creep, stoppable(twist, second_contact(narrow_, twist, view.points), moves)));
}

bool Guard::stops(const geometry::Twist2& twist, std::span<const geometry::Point2> points) const {
  const double contact = second_contact(wide_, twist, points);
  return contact == kNever ||
         parameters_.stopping.distance(std::abs(twist.v)) <= std::abs(twist.v) * contact;
}

double Guard::way(const geometry::Twist2& twist, std::span<const geometry::Point2> points) const {
  const geometry::Twist2 driven = twist.v == 0.0 ? geometry::Twist2{1.0, 0.0} : twist;
  return std::abs(driven.v) * second_contact(parameters_.outline, driven, points);
}

}  // namespace usher::movement_control
