#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "navigation/costmap/core/cells.hpp"

namespace usher::costmap {

/// The occupancy map, sampled into the window through a transform: a cell gets the state of the map
/// at its centre. A map finer than the window is widened first, so that no thin wall falls between
/// samples.
///
/// Map coordinates are linear in the window's cell; they are evaluated in fixed point (2^-32 of a
/// map cell) from the raster's anchor, so a sample does not depend on where the window lies or
/// which part of it is sampled.
class StaticLayer {
 public:
  explicit StaticLayer(cpu::Simd simd = cpu::best_simd());

  /// Occupancy of `occupied_from` percent and more is occupied, below free, negative unknown.
  /// Refuses a map that is empty, too fine, or has more than 2^29 cells. `resolution` is that of
  /// the window.
  Status set_map(const grid::OccupancyGrid& map, int occupied_from, double resolution);
  bool has_map() const { return !states_.empty(); }

  /// Writes the states of the window's cells in `cells` to `window` (kUnseen beyond the map).
  void sample(const geometry::Pose2& map_T_window, const Raster& raster, const CellRect& cells,
              grid::Grid<std::uint8_t>& window) const;

  /// One run of samples: coordinates in cells of the map, 32 bits of fraction.
  struct Run {
    std::int64_t x;
    std::int64_t y;
    std::int64_t step_x;
    std::int64_t step_y;
    int count;
  };
  using SampleFunction = void (*)(const std::uint8_t* map, int map_width, const Run& run,
                                  std::uint8_t* states);

 private:
  grid::GridGeometry geometry_;
  std::vector<std::uint8_t>
      states_;  // and a few bytes more, since the vector kernel reads four at a time
  SampleFunction sample_;
};

}  // namespace usher::costmap
