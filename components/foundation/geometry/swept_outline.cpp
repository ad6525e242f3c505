#include "foundation/geometry/swept_outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace usher::geometry {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kStraight = 1e-6;  // [rad/m] flatter arcs are straight lines
constexpr double kOnSide = 1e-9;    // [m]

}  // namespace

SweptOutline::SweptOutline(const Footprint& outline, const Twist2& twist)
    : twist_(twist.finite() ? twist : Twist2{}),
      turns_(std::abs(twist_.w) > kStraight * std::abs(twist_.v)),
      moves_(twist_ != Twist2{}) {
  if (turns_) {
    center_ = {0.0, twist_.v / twist_.w};
    inner_ = outline.distance(center_) - kOnSide;
    for (const Point2& corner : outline.corners())
      outer_ = std::max(outer_, (corner - center_).norm() + kOnSide);
  }
  for (const Footprint::Side& side : outline.sides()) {
    edges_[count_++] = {side, std::atan2(side.normal_y, side.normal_x),
                        side.normal_y * center_.y()};
  }
}

/// Of the point, seen from the robot.
Point2 SweptOutline::velocity(const Point2& point) const {
  const double w = turns_ ? twist_.w : 0.0;
  return {-twist_.v + w * point.y(), -w * point.x()};
}

/// Where the point is then, seen from the robot.
Point2 SweptOutline::after(const Point2& point, double seconds) const {
  if (!turns_) return {point.x() - twist_.v * seconds, point.y()};
  const double c = std::cos(twist_.w * seconds);
  const double s = std::sin(twist_.w * seconds);
  const Point2 arm = point - center_;
  return {center_.x() + c * arm.x() + s * arm.y(), center_.y() - s * arm.x() + c * arm.y()};
}

bool SweptOutline::inside(const Point2& point) const {
  return std::all_of(edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(count_),
                     [&](const Edge& edge) {
                       return edge.side.normal_x * point.x() + edge.side.normal_y * point.y() <=
                              edge.side.offset + kOnSide;
                     });
}

/// [s] until the point crosses the line of this side inward; infinity where it does not.
double SweptOutline::entry(const Edge& edge, const Point2& point) const {
  if (!turns_) {
    const double closing = edge.side.normal_x * twist_.v;  // [m/s]
    if (!(closing > 0.0)) return kNever;
    const double gap =
        edge.side.normal_x * point.x() + edge.side.normal_y * point.y() - edge.side.offset;
    return gap >= 0.0 ? gap / closing : kNever;
  }
  // On its circle around the center of the turn the point is at the angle a - w t, and crosses the
  // line where r cos(a - w t - bearing) is the line's distance; inward on one of the two sides.
  const Point2 arm = point - center_;
  const double share = (edge.side.offset - edge.center) / arm.norm();
  if (!(std::abs(share) <= 1.0)) return kNever;
  const double crossing = -std::copysign(std::acos(share), twist_.w);
  const double turn =
      (std::atan2(arm.y(), arm.x()) - edge.bearing - crossing) * (twist_.w > 0.0 ? 1.0 : -1.0);
  const double ahead = std::fmod(turn, 2.0 * kPi);
  return (ahead < 0.0 ? ahead + 2.0 * kPi : ahead) / std::abs(twist_.w);
}

double SweptOutline::contact(const Point2& point) const {
  if (!moves_) return kNever;
  if (turns_) {
    const double away = (point - center_).norm();
    if (away < inner_ || away > outer_) return kNever;
  }
  if (inside(point)) {
    const Edge* nearest = edges_.data();
    double depth = kNever;
    for (std::size_t i = 0; i < count_; ++i) {
      const auto& side = edges_[i].side;
      const double d = side.offset - side.normal_x * point.x() - side.normal_y * point.y();
      if (d < depth) depth = d, nearest = &edges_[i];
    }
    const Point2 moves = velocity(point);
    if (nearest->side.normal_x * moves.x() + nearest->side.normal_y * moves.y() < -kOnSide)
      return 0.0;
  }
  double first = kNever;
  for (std::size_t i = 0; i < count_; ++i) {
    const double at = entry(edges_[i], point);
    if (at < first && inside(after(point, at))) first = at;
  }
  return first;
}

}  // namespace usher::geometry
