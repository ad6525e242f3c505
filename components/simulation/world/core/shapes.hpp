#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "foundation/geometry/pose2.hpp"

/// Distances between small convex shapes in the plane [m].
namespace usher::world::shapes {

using geometry::Point2;

inline double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

inline Point2 nearest_on_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  const double length2 = along.squaredNorm();
  if (length2 == 0.0) return a;
  return a + std::clamp((p - a).dot(along) / length2, 0.0, 1.0) * along;
}

inline double distance(const Point2& p, const Point2& a, const Point2& b) {
  return (p - nearest_on_segment(p, a, b)).norm();
}

/// Whether two segments share a point; touching ends count, collinear overlaps are left to the end
/// distances.
inline bool cross_each_other(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const double ca = cross(d - c, a - c);
  const double cb = cross(d - c, b - c);
  const double cc = cross(b - a, c - a);
  const double cd = cross(b - a, d - a);
  return ca * cb < 0.0 && cc * cd < 0.0;
}

/// How far a polygon is from another shape, and where on that shape.
struct Gap {
  double distance;  ///< [m] 0: they touch or overlap
  Point2 on_other;
};

/// A view of a convex counter-clockwise polygon of one (a point) or at least three corners, with a
/// circle around it.
class Polygon {
 public:
  explicit Polygon(std::span<const Point2> corners) : corners_(corners) {
    for (const Point2& p : corners) center_ += p / static_cast<double>(corners.size());
    for (const Point2& p : corners) radius_ = std::max(radius_, (p - center_).norm());
  }

  const Point2& center() const { return center_; }
  double radius() const { return radius_; }

  bool contains(const Point2& p) const {
    if (corners_.size() < 3) return false;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (cross(end(i) - corners_[i], p - corners_[i]) < 0.0) return false;
    }
    return true;
  }

  /// Zero for a point inside.
  double distance_to(const Point2& p) const {
    if (contains(p)) return 0.0;
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      best = std::min(best, distance(p, corners_[i], end(i)));
    }
    return best;
  }

  Gap gap_to_disc(const Point2& center, double radius) const {
    Point2 nearest = center;
    if (!contains(center)) {
      double best = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Point2 p = nearest_on_segment(center, corners_[i], end(i));
        const double d = (p - center).norm();
        if (d < best) best = d, nearest = p;
      }
    }
    const Point2 out = nearest - center;
    const double d = out.norm();
    return d <= radius ? Gap{0.0, nearest} : Gap{d - radius, center + out * (radius / d)};
  }

  Gap gap_to_segment(const Point2& a, const Point2& b) const {
    if (contains(a)) return {0.0, a};
    Gap gap{std::numeric_limits<double>::infinity(), a};
    const auto offer = [&](const Point2& mine, const Point2& other) {
      const double d = (mine - other).norm();
      if (d < gap.distance) gap = {d, other};
    };
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Point2& c = corners_[i];
      const Point2& d = end(i);
      if (corners_.size() > 1 && cross_each_other(a, b, c, d)) return {0.0, c};
      offer(c, nearest_on_segment(c, a, b));
      offer(nearest_on_segment(a, c, d), a);
      offer(nearest_on_segment(b, c, d), b);
    }
    return gap;
  }

  Gap gap_to_polygon(std::span<const Point2> other) const {
    if (Polygon(other).contains(corners_[0])) return {0.0, corners_[0]};
    Gap gap{std::numeric_limits<double>::infinity(), other[0]};
    for (std::size_t i = 0; i < other.size(); ++i) {
      const Gap g = gap_to_segment(other[i], other[(i + 1) % other.size()]);
      if (g.distance < gap.distance) gap = g;
    }
    return gap;
  }

 private:
  const Point2& end(std::size_t i) const { return corners_[(i + 1) % corners_.size()]; }

  std::span<const Point2> corners_;
  Point2 center_ = Point2::Zero();
  double radius_ = 0.0;
};

}  // namespace usher::world::shapes
