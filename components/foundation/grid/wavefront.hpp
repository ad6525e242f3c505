#pragma once

#include <cstdint>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::grid {

/// Lengths of shortest ways around obstacles from every cell to one target cell: 8-connected,
/// chamfer weights 5 and 7 (fifths of a cell, at most 8 % longer than straight)
/// [borgefors1986distance].
///
/// Computed by sweeps, not by a queue: a sweep takes a whole row from the row before it, so all
/// columns advance at once (SIMD), first downward and upward, then on the transposed grid leftward
/// and rightward, until nothing changes. Free space needs one round, each bend of the shortest way
/// at most one more.
class Wavefront {
 public:
  static constexpr std::uint16_t kUnreachable = 65000;
  static constexpr int kUnitsPerCell = 5;
  static constexpr int kLargestSide = 2000;  ///< [cells] of a grid

  explicit Wavefront(cpu::Simd simd = cpu::best_simd()) : avx2_(simd == cpu::Simd::kAvx2) {}

  /// Which cells are closed: those of at least `closed_from`, unknown ones (255) when
  /// `unknown_is_closed`. Serves any number of spread() calls. Allocates only when the grid grows.
  void set_obstacles(const Grid<std::uint8_t>& costs, std::uint8_t closed_from,
                     bool unknown_is_closed);

  /// Lengths to `target`, which must be inside the grid and may be closed. Lengths beyond
  /// kUnreachable count as it.
  void spread(Cell target, std::vector<std::uint16_t>& lengths);

  /// Of the last spread(): rounds that it took.
  int rounds() const { return rounds_; }

 private:
  struct Plane {  // rows with a rim of closed cells, so that sweeps need no bounds
    int width = 0, height = 0;
    std::size_t stride = 0;
    std::vector<std::uint16_t> closed;  // 0 or 0xffff
    std::vector<std::uint16_t> lengths;
    void resize(int w, int h);
    std::size_t index(int x, int y) const {
      return static_cast<std::size_t>(y + 1) * stride + static_cast<std::size_t>(x) + kLeft;
    }
  };
  static constexpr std::size_t kLeft = 16;

  bool sweep(Plane& plane) const;

  bool avx2_ = false;
  int rounds_ = 0;
  Plane upright_;
  Plane lying_;  // transposed
};

}  // namespace usher::grid
