#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/grid/grid.hpp"
#include "navigation/costmap/core/cells.hpp"
#include "navigation/costmap/core/costs.hpp"

namespace usher::costmap {

/// Turns a window of cell states into costs by the exact Euclidean distance, centre to centre, to
/// the nearest occupied cell.
///
/// The distance transform is separable [felzenszwalb2012distance] and cut off at the inflation
/// radius of R cells: first per row the distance to the nearest occupied cell in the row (log R
/// steps of a vector minimum), then per column the best of the 2 R + 1 rows around, where cost(dy,
/// dx) is one byte shuffle since the cost only falls with distance. Both passes keep their result,
/// so that update() redoes only what a changed rectangle reaches.
class Inflation {
 public:
  /// The widest inflation radius in cells.
  static constexpr int kMaxReach = 120;
  /// Vectors of this many cells; rows of the working grids are padded to whole blocks.
  static constexpr int kBlock = 32;

  /// What becomes of cells whose state is kUnseen.
  enum class Unseen {
    kFree,     ///< they cost what free cells cost
    kUnknown,  ///< unknown, unless an obstacle is within the inscribed radius (as costmap_2d)
    kInflate   ///< unknown, unless an obstacle is within the inflation radius
  };

  /// The inflation radius must be at most kMaxReach cells.
  Inflation(int width, int height, double resolution, const CostDecay& decay, Unseen unseen,
            cpu::Simd simd = cpu::best_simd());

  /// Row of states to be written by the caller, `width` cells; initially kUnseen.
  std::uint8_t* state_row(int y) { return states_.data() + offset(y); }
  const std::uint8_t* state_row(int y) const { return states_.data() + offset(y); }

  /// Writes the costs of all cells that the states within `changed` can reach to `master` (width x
  /// height), and returns the rectangle that it wrote. States outside of `changed` must be the same
  /// as at the last call.
  CellRect update(const CellRect& changed, grid::Grid<std::uint8_t>& master);

  /// The inflation radius in whole cells.
  int reach() const { return reach_; }

  /// Costs of one block of kBlock cells from the row distances around it; `center` points to the
  /// block in its row.
  struct Kernel {
    int reach;
    std::ptrdiff_t stride;
    const std::uint8_t* tables;   ///< (reach + 1) x kTable: cost by |dy| and row distance
    const std::uint8_t* squared;  ///< cost by squared distance in cells
  };
  static constexpr int kTable = 32;
  using BlockFunction = void (*)(const Kernel&, const std::uint8_t* center, std::uint8_t* costs);
  using SeedFunction = void (*)(const std::uint8_t* states, std::uint8_t none, int count,
                                std::uint8_t* to);
  using SpreadFunction = void (*)(const std::uint8_t* from, int step, int count, std::uint8_t* to);

 private:
  std::size_t offset(int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_);
  }
  std::uint8_t* distance_row(int y) { return distances_.data() + offset(y + reach_); }
  std::uint8_t* active_row(int y) {
    return active_.data() + static_cast<std::ptrdiff_t>(y + reach_) * blocks_;
  }
  void measure_row(int y, int first_block, int last_block);
  void write_row(int y, int first_block, int last_block, std::uint8_t* master_row);

  int width_;
  int height_;
  int reach_;
  int blocks_;
  int stride_;
  std::uint8_t none_;  // row distance that means: beyond the radius
  std::uint8_t
      unseen_below_;  // unseen cells of a smaller cost are unknown; 0 when unseen cells are free
  std::vector<int> steps_;  // subset sums give every distance up to the reach
  std::vector<std::uint8_t> states_;
  std::vector<std::uint8_t> distances_;  // reach_ rows of none_ above and below
  std::vector<std::uint8_t> active_;     // per row and block: does any cell have a row distance
  std::vector<int> active_around_;       // per block: active rows within reach
  std::vector<std::uint8_t> scratch_a_;
  std::vector<std::uint8_t> scratch_b_;
  std::vector<std::uint8_t> tables_;
  std::vector<std::uint8_t> squared_;
  BlockFunction block_;
  SeedFunction seed_;
  SpreadFunction spread_;
};

}  // namespace usher::costmap
