#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/result/result.hpp"

namespace usher::geometry {

/// The outline of the robot on the floor: a convex polygon in base_footprint, counter-clockwise,
/// around the origin.
class Footprint {
 public:
  static constexpr std::size_t kMaxCorners = 64;

  /// 3 to 64 finite corners in order (either sense), convex, the origin strictly inside, no side
  /// shorter than 1 mm.
  static Result<Footprint> make(std::span<const Point2> corners);
  /// A rectangle `length` along x and `width` along y, centered on the origin; both positive.
  static Footprint rectangle(double length, double width);

  /// Side i leads from corner i to corner i + 1; its points satisfy normal . p = offset, inside is
  /// less.
  struct Side {
    double normal_x = 0.0;  ///< outward unit normal
    double normal_y = 0.0;
    double offset = 0.0;  ///< [m]
  };

  std::span<const Point2> corners() const { return corners_; }
  std::span<const Side> sides() const { return sides_; }
  double inscribed_radius() const {
    return inscribed_;
  }  ///< [m] largest circle around the origin inside
  double circumscribed_radius() const {
    return circumscribed_;
  }  ///< [m] smallest circle around the origin outside

  /// [m] How far its corners reach to the left or right of the origin, whichever is more.
  double half_width() const;

  /// Distance from a point in base_footprint to the polygon [m]; zero inside.
  double distance(const Point2& point) const;

  /// Every side moved outward by `padding` [m], not negative; corners stay sharp.
  Footprint grown(double padding) const;

 private:
  explicit Footprint(std::vector<Point2> corners);

  std::vector<Point2> corners_;
  std::vector<Side> sides_;
  double inscribed_ = 0.0;
  double circumscribed_ = 0.0;
};

}  // namespace usher::geometry
