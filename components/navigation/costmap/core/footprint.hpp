#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"

namespace usher::costmap {

/// The outline of the robot on the floor: a simple polygon, convex or not, either way round, in the
/// base frame [m].
class Footprint {
 public:
  static constexpr std::size_t kMaxCorners = 64;

  /// An error for fewer than 3 or more than kMaxCorners corners, a corner that is not finite or
  /// farther than 100 m, or no area. That the polygon does not cross itself is the caller's
  /// promise.
  static Result<Footprint> make(std::vector<geometry::Point2> corners);

  std::span<const geometry::Point2> corners() const { return corners_; }
  /// Distance [m] from the base's origin to the nearest edge; 0 when the origin lies outside of the
  /// polygon.
  double inscribed_radius() const { return inscribed_radius_; }
  /// Distance [m] from the base's origin to the farthest corner.
  double circumscribed_radius() const { return circumscribed_radius_; }

 private:
  explicit Footprint(std::vector<geometry::Point2> corners);

  std::vector<geometry::Point2> corners_;
  double inscribed_radius_ = 0.0;
  double circumscribed_radius_ = 0.0;
};

/// A run of cells x0 <= x < x1 of row y.
struct CellSpan {
  int y;
  int x0;
  int x1;
};

/// The cells of a grid that a polygon touches with its interior or an edge, exactly: a cell is the
/// half-open square [x, x+1) x [y, y+1), the polygon is closed (it may in addition give a cell that
/// it meets in nothing but a point of its upper border). Runs come in rising order, do not overlap
/// or touch, and are clipped to the grid. O(corners) per row, no allocation.
class PolygonRaster {
 public:
  /// Places the footprint at a finite pose; `geometry` in the same frame as the pose.
  PolygonRaster(const Footprint& footprint, const geometry::Pose2& pose,
                const grid::GridGeometry& geometry);

  /// True when a part of the polygon lies outside of the grid.
  bool leaves_grid() const { return leaves_grid_; }

  /// Calls `visit(CellSpan)` for each run.
  template <class Visit>
  void for_each_span(Visit&& visit) const {
    for (int y = first_row_; y < end_row_; ++y) {
      std::array<CellSpan, kMaxSpans> spans;
      const std::size_t count = row_spans(y, spans);
      for (std::size_t i = 0; i < count; ++i) visit(spans[i]);
    }
  }

 private:
  // Every edge gives at most one run, every pair of crossings another.
  static constexpr std::size_t kMaxSpans = Footprint::kMaxCorners + Footprint::kMaxCorners / 2;

  std::size_t row_spans(int y, std::array<CellSpan, kMaxSpans>& spans) const;

  std::array<double, Footprint::kMaxCorners + 1>
      x_;  // corners in cells, the first repeated at the end
  std::array<double, Footprint::kMaxCorners + 1> y_;
  std::size_t corners_ = 0;
  int width_ = 0;
  int first_row_ = 0;
  int end_row_ = 0;
  bool leaves_grid_ = false;
};

/// What lies under a footprint.
struct FootprintReading {
  std::uint8_t highest_cost = 0;  ///< of the known cells; kLethalCost is contact
  bool touches_unknown = false;
  bool leaves_grid = false;  ///< a part is outside of the grid, where nothing is known

  bool operator==(const FootprintReading&) const = default;
};

/// Reads all cells of a cost grid that the footprint touches at a pose in the grid's frame. A pose
/// that is not finite reads as outside of the grid.
FootprintReading footprint_reading(const grid::Grid<std::uint8_t>& costs,
                                   const Footprint& footprint, const geometry::Pose2& pose);

}  // namespace usher::costmap
