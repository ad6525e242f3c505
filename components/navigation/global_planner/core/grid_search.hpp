#pragma once

#include <cstdint>
#include <vector>

#include "navigation/global_planner/core/band_queue.hpp"
#include "navigation/global_planner/core/cost_field.hpp"

namespace usher::global_planner {

enum class SearchOutcome : std::uint8_t { kReached, kDisconnected, kTooLong };

/// Exact cheapest paths on the eight-connected grid, where a diagonal step needs both cells beside
/// it to be free.
///
/// Dijkstra's algorithm and A* (octile distance times the least step cost) over a bucket queue
/// [dial1969]. A bucket is no wider than the cheapest step, so Dijkstra settles a bucket's cells in
/// any order [dinitz1978]; A* may reopen a cell. Inside a bucket there is one list per direction of
/// arrival. That makes the expansion branch-free in what it looks at: five of the eight neighbours
/// (the parent reaches the others at no higher cost), and on uniform costs the canonical successors
/// only [harabor2011jps] [sturtevant2016canonical]: one for a straight move in the open, three for
/// a diagonal one. The parent is not stored: the way back follows the costs.
///
/// Costs of earlier searches stay in memory: each search counts below all earlier ones, so that an
/// old value reads as "not reached" and nothing is cleared.
class GridSearch {
 public:
  /// Searches from start until the goal is settled; both must be traversable cells of the field.
  /// `informed` is A*.
  SearchOutcome run(const CostField& field, grid::Cell start, grid::Cell goal, bool informed);

  /// Whether the last search found a path to this cell. After kDisconnected these are all cells
  /// that can be reached.
  bool reached(const CostField& field, grid::Cell c) const {
    return values_[field.index(c)] < ceiling_;
  }
  /// The cost of the best path that the last search found to a cell that it reached.
  std::uint32_t cost_to(const CostField& field, grid::Cell c) const {
    return values_[field.index(c)] - base_;
  }
  /// The cells from the start of the last search to a cell that it reached, both included.
  void trace(const CostField& field, grid::Cell to, std::vector<grid::Cell>& cells) const;

  std::uint32_t expanded() const { return expanded_; }

 private:
  struct Target {
    int x;
    int y;
    std::uint32_t straight;                            // least cost of a step
    std::uint32_t bend;                                // what a diagonal step costs more
    std::uint32_t estimate(std::uint32_t from) const;  // from: y << 16 | x
  };

  void clear(std::size_t size);
  void prepare(const CostField& field);
  template <bool kInformed, bool kUniform>
  SearchOutcome attempt(const CostField& field, grid::Cell start, grid::Cell goal);
  template <bool kInformed, bool kUniform, int kDirection>
  void expand(const CostField& field, const Target& target, std::uint32_t band);
  template <bool kInformed, bool kUniform>
  bool expand_band(const CostField& field, const Target& target, std::uint32_t band);

  std::vector<std::uint32_t>
      values_;  // base_ + cost of the path, or ceiling_ and more: not reached
  std::uint32_t base_ = 0;
  std::uint32_t ceiling_ = 0;
  BandQueue queue_;  // list = band * 8 + direction of arrival; entry = value << 32 | y << 16 | x
  std::uint32_t bands_ = 0;
  int band_shift_ = 0;
  std::uint32_t expanded_ = 0;
};

}  // namespace usher::global_planner
