#pragma once

#include <array>
#include <cstddef>

#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::geometry {

/// The outline of a robot that moves with a constant twist: straight ahead, along an arc, or
/// turning on the spot, corners included.
class SweptOutline {
 public:
  /// Copies the outline. A twist that is zero or not finite meets nothing.
  SweptOutline(const Footprint& outline, const Twist2& twist);

  /// [s] {>= 0} of this motion until the outline meets a point that stands still, given in
  /// base_footprint; infinity where it never does. For a point inside the outline: zero when it
  /// gets deeper behind its nearest side, else until it is met again; so a robot may slide along
  /// what it touches, and away from it. O(sides), no allocation.
  double contact(const Point2& point) const;

 private:
  struct Edge {
    Footprint::Side side;
    double bearing = 0.0;  ///< [rad] of the normal
    double center = 0.0;   ///< [m] normal . center of the turn
  };

  double entry(const Edge& edge, const Point2& point) const;
  Point2 after(const Point2& point, double seconds) const;
  Point2 velocity(const Point2& point) const;
  bool inside(const Point2& point) const;

  Twist2 twist_;
  bool turns_ = false;
  bool moves_ = false;
  Point2 center_ = Point2::Zero();  ///< of the turn, in base_footprint
  /// [m] from there to what the outline sweeps: what is nearer or farther is never met.
  double inner_ = 0.0, outer_ = 0.0;
  std::array<Edge, Footprint::kMaxCorners> edges_{};
  std::size_t count_ = 0;
};

}  // namespace usher::geometry
