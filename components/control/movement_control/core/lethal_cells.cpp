#include "control/movement_control/core/lethal_cells.hpp"

#include <algorithm>
#include <cmath>

#include "foundation/grid/costs.hpp"

namespace usher::movement_control {

using geometry::Point2;

namespace {

constexpr std::size_t kMostCells = 4096;

}  // namespace

LethalCells::LethalCells() { cells_.reserve(kMostCells); }

/// The cells of a row from one column to another; these need not be in the window.
void LethalCells::take_row(const CostsView& window, const Raster& raster, std::size_t row,
                           double from, double to) {
  const double columns = static_cast<double>(window.width);
  const auto first = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(from), 0.0, columns));
  const auto last = static_cast<std::ptrdiff_t>(std::clamp(std::floor(to) + 1.0, 0.0, columns));
  if (first >= last) return;
  const auto begin = window.costs.begin() + static_cast<std::ptrdiff_t>(row * window.width);
  const Point2 start = raster.first + static_cast<double>(row) * raster.row;
  for (auto cell = begin + first;
       (cell = std::find(cell, begin + last, grid::kLethalCost)) != begin + last; ++cell) {
    if (cells_.size() == kMostCells) return;
    cells_.push_back(start + static_cast<double>(cell - begin) * raster.column);
  }
}

std::span<const Point2> LethalCells::around(const geometry::Pose2& window_T_base,
                                            const CostsView& window, double reach) {
  cells_.clear();
  if (window.costs.empty() || window.costs.size() != window.width * window.height ||
      !(window.resolution > 0.0) || !window.origin.allFinite() || !window_T_base.finite() ||
      !(reach >= 0.0))
    return {};
  // In cells, from the first cell's center.
  const double cell = window.resolution, radius = reach / cell;
  const double x = (window_T_base.x - window.origin.x()) / cell - 0.5;
  const double y = (window_T_base.y - window.origin.y()) / cell - 0.5;
  const auto rows = static_cast<double>(window.height);
  const double nearest = std::round(y), column = std::round(x);
  if (!(nearest >= 0.0 && nearest < rows && column >= 0.0 &&
        column < static_cast<double>(window.width)))
    return {};
  const geometry::Pose2 base_T_window = geometry::inverse(window_T_base);
  const double c = cell * std::cos(base_T_window.yaw), s = cell * std::sin(base_T_window.yaw);
  const Raster raster{base_T_window * Point2(window.origin.array() + 0.5 * cell), {c, s}, {-s, c}};
  const auto farthest = static_cast<int>(std::min(radius + 1.0, rows));
  for (int away = 0; away <= farthest; ++away) {
    for (const int side : {-1, 1}) {
      const double row = nearest + side * away;
      const double half = std::sqrt(radius * radius - (row - y) * (row - y));
      if (half >= 0.0 && row >= 0.0 && row < rows)
        take_row(window, raster, static_cast<std::size_t>(row), x - half, x + half);
      if (away == 0) break;
    }
  }
  return cells_;
}

}  // namespace usher::movement_control
