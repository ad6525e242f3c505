#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::costmap {

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
  static constexpr std::size_t kMaxCorners = geometry::Footprint::kMaxCorners;

  /// Places a polygon at a finite pose; `geometry` in the same frame as the pose. 3 to kMaxCorners
  /// corners in the base frame [m], either way round, convex or not; that the sides do not cross is
  /// the caller's promise.
  PolygonRaster(std::span<const geometry::Point2> polygon, const geometry::Pose2& pose,
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
  /// Calls `visit(CellSpan)` for the cells of each row that lie wholly inside of a convex polygon.
  template <class Visit>
  void for_each_inner_span(Visit&& visit) const {
    for (int y = first_row_; y < end_row_; ++y) {
      const CellSpan span = inner_span(y);
      if (span.x0 < span.x1) visit(span);
    }
  }

 private:
  // Every edge gives at most one run, every pair of crossings another.
  static constexpr std::size_t kMaxSpans = kMaxCorners + kMaxCorners / 2;

  std::size_t row_spans(int y, std::array<CellSpan, kMaxSpans>& spans) const;
  CellSpan inner_span(int y) const;

  std::array<double, kMaxCorners + 1> x_;  // corners in cells, the first repeated at the end
  std::array<double, kMaxCorners + 1> y_;
  std::size_t corners_ = 0;
  int width_ = 0;
  int first_row_ = 0;
  int end_row_ = 0;
  bool leaves_grid_ = false;
};

}  // namespace usher::costmap
