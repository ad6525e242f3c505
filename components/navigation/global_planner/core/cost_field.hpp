#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "navigation/global_planner/core/global_planner.hpp"

namespace usher::global_planner {

/// What entering a cell costs, by its costmap value. Integers, so that sums are the same on every
/// machine.
struct StepCosts {
  /// The cost of a cell that must not be entered: larger than any sum of steps, even with other
  /// bits set.
  static constexpr std::uint32_t kBlocked = 1u << 31;

  std::array<std::uint32_t, 256> straight;
  std::array<std::uint32_t, 256> diagonal;
  std::uint32_t least_straight;
  std::uint32_t least_diagonal;
  std::uint32_t greatest_diagonal;
  bool uniform;  ///< every cell that may be entered costs the same

  /// straight = 70 w, diagonal = 99 w (99/70 is sqrt 2 to 5e-5) with w = round(neutral + factor *
  /// cost).
  static StepCosts inflated(double neutral, double factor, bool allow_unknown, int unknown_cost);
  /// straight = 408, diagonal = 577 (577/408 is sqrt 2 to 2e-6) for every cell below
  /// grid::kInscribedCost.
  static StepCosts shortest(bool allow_unknown);
};

/// A copy of a map's costs inside a border of lethal cells, so that a search looks at neighbours
/// without asking whether they exist.
class CostField {
 public:
  explicit CostField(const StepCosts& steps) : steps_(steps) {}

  /// Cost: one copy of the map (0.03 ms for 10^6 cells).
  void load(const CostGrid& costs);

  const StepCosts& steps() const { return steps_; }
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return stride_; }
  std::size_t size() const { return cells_.size(); }
  const std::uint8_t* data() const { return cells_.data(); }
  /// Index of a cell; -1 and width (height) are the border.
  std::size_t index(grid::Cell c) const {
    return static_cast<std::size_t>(c.y + 1) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(c.x + 1);
  }
  bool contains(grid::Cell c) const {
    return c.x >= 0 && c.y >= 0 && c.x < width_ && c.y < height_;
  }
  std::uint8_t cost(grid::Cell c) const { return cells_[index(c)]; }
  /// The cost of a straight step into a cell; kBlocked when it must not be entered.
  std::uint32_t straight(grid::Cell c) const { return steps_.straight[cells_[index(c)]]; }
  bool traversable(grid::Cell c) const { return straight(c) != StepCosts::kBlocked; }

 private:
  StepCosts steps_;
  int width_ = 0;
  int height_ = 0;
  int stride_ = 0;
  std::vector<std::uint8_t> cells_;
};

}  // namespace usher::global_planner
