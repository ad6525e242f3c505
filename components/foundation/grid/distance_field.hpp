#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/grid/ray_cast.hpp"

namespace usher::grid {

/// For every cell the exact Euclidean distance between its centre and the centre of the nearest
/// occupied cell, truncated at a radius. Kept as squared whole cells, so it is the same on every
/// machine.
///
/// Two passes as in [felzenszwalb2012distance]: along columns by sweeps, along rows by the minimum
/// over the radius, which stops as soon as no farther column can win. O(cells x radius), in
/// practice memory bound: vectors of 16 cells.
class DistanceField {
 public:
  /// The largest radius in cells: both squares must fit 16 bits.
  static constexpr int kMaxRadius = 181;

  struct Sample {
    double distance = 0.0;      ///< [m]
    geometry::Point2 gradient;  ///< [m/m] of the distance at the point
  };

  /// Measures the distance to cells with a value of `occupied_from` and more. The radius [m] is
  /// rounded down to whole cells (at least 1, at most kMaxRadius); without any occupied cell every
  /// distance is the radius. Keeps its memory for the next build.
  void build(const OccupancyGrid& map, double radius, std::int8_t occupied_from = kOccupied,
             cpu::Simd simd = cpu::best_simd());

  const GridGeometry& geometry() const { return squared_.geometry(); }
  bool empty() const { return squared_.empty(); }
  /// The truncation in effect [m] and [cells].
  double radius() const { return radius_ * squared_.resolution(); }
  int radius_cells() const { return radius_; }

  /// Squared distances [cells^2] in 0..radius_cells()^2, the largest value meaning "at least the
  /// radius".
  const Grid<std::uint16_t>& squared_cells() const { return squared_; }
  /// [m] The cell must be in the grid.
  double distance(Cell cell) const { return root_[squared_.at(cell)] * squared_.resolution(); }
  /// Bilinear between cell centres, with the gradient of that surface. Outside the outermost
  /// centres: the radius, and no gradient.
  Sample interpolated(const geometry::Point2& point) const;

  /// cast_ray() against the occupied cells, flying over what the field knows to be free.
  std::optional<RayHit> cast_ray(const geometry::Point2& start, double direction,
                                 double max_range) const;

 private:
  int radius_ = 0;
  Grid<std::uint16_t> squared_;
  std::vector<float> root_;            // of 0 .. radius^2 [cells]
  std::vector<std::uint8_t> columns_;  // vertical distance, truncated
  std::vector<std::uint16_t> row_;     // its square, padded on both sides
};

}  // namespace usher::grid
