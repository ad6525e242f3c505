#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "foundation/grid/grid.hpp"

namespace usher::costmap {

/// What a layer knows of a cell. The order is the rule of combination: the maximum over layers.
inline constexpr std::uint8_t kUnseen = 0;
inline constexpr std::uint8_t kSeenFree = 1;
inline constexpr std::uint8_t kSeenOccupied = 2;

/// The farthest coordinate [m] that a costmap deals with and its finest resolution [m]: so cells
/// always fit an int.
inline constexpr double kFarthestCoordinate = 1e5;
inline constexpr double kFinestResolution = 1e-3;

/// std::floor for a value that fits an int; without SSE4.1 the library's costs a call.
inline int floor_to_int(double value) {
  const int truncated = static_cast<int>(value);
  return truncated - (value < truncated ? 1 : 0);
}

/// Cells x0 <= x < x1, y0 <= y < y1. Default: empty.
struct CellRect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool operator==(const CellRect&) const = default;
  CellRect grown(int cells) const { return {x0 - cells, y0 - cells, x1 + cells, y1 + cells}; }
  CellRect moved(int dx, int dy) const { return {x0 + dx, y0 + dy, x1 + dx, y1 + dy}; }
  CellRect within(const CellRect& other) const {
    return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1),
            std::min(y1, other.y1)};
  }
  /// The smallest rectangle that holds both; an empty one counts as nothing.
  CellRect united(const CellRect& other) const {
    if (empty()) return other;
    if (other.empty()) return *this;
    return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1),
            std::max(y1, other.y1)};
  }
};

/// Collects the rectangle around single cells.
class CellBounds {
 public:
  void include(grid::Cell cell) {
    low_x_ = std::min(low_x_, cell.x), high_x_ = std::max(high_x_, cell.x);
    low_y_ = std::min(low_y_, cell.y), high_y_ = std::max(high_y_, cell.y);
  }
  /// Empty when no cell was included. Cells must be below the largest int.
  CellRect rect() const {
    return low_x_ > high_x_ ? CellRect{} : CellRect{low_x_, low_y_, high_x_ + 1, high_y_ + 1};
  }

 private:
  int low_x_ = std::numeric_limits<int>::max();
  int low_y_ = std::numeric_limits<int>::max();
  int high_x_ = std::numeric_limits<int>::min();
  int high_y_ = std::numeric_limits<int>::min();
};

/// The raster of a window in its frame: cell (0,0) of the window is cell (first_x, first_y) of an
/// endless raster anchored at (anchor_x, anchor_y). A moving window changes only first_x and
/// first_y, so what depends on the raster (not the window) gives the same bits wherever the window
/// lies.
struct Raster {
  double anchor_x = 0.0;  ///< [m]
  double anchor_y = 0.0;  ///< [m]
  double resolution = 0.0;
  double cells_per_meter = 0.0;
  int first_x = 0;
  int first_y = 0;
  int width = 0;
  int height = 0;

  CellRect all() const { return {0, 0, width, height}; }
  /// The window's cell of a finite point within kFarthestCoordinate; it may lie outside the window.
  grid::Cell cell_at(double x, double y) const {
    return {floor_to_int((x - anchor_x) * cells_per_meter) - first_x,
            floor_to_int((y - anchor_y) * cells_per_meter) - first_y};
  }
  geometry::Point2 center(grid::Cell cell) const {
    return {anchor_x + (first_x + cell.x + 0.5) * resolution,
            anchor_y + (first_y + cell.y + 0.5) * resolution};
  }
};

inline bool reachable(double x, double y) {  // false for NaN too
  return std::abs(x) <= kFarthestCoordinate && std::abs(y) <= kFarthestCoordinate;
}

/// Moves the content of a row-major window so that cell (x, y) holds what (x + dx, y + dy) held;
/// what comes in from outside is `fill`.
template <class T>
void shift_cells(std::vector<T>& cells, int width, int height, int dx, int dy, T fill) {
  const auto row = [&](int y) { return cells.data() + static_cast<std::ptrdiff_t>(y) * width; };
  const int kept = std::max(0, width - std::abs(dx));
  const int first = dx >= 0 ? 0 : width - kept;  // column of the first kept cell, after the move
  for (int i = 0; i < height; ++i) {
    const int y = dy >= 0 ? i : height - 1 - i;  // a row is read before it is overwritten
    const int from = y + dy;
    T* to = row(y);
    if (from < 0 || from >= height || kept == 0) {
      std::fill(to, to + width, fill);
      continue;
    }
    std::memmove(to + first, row(from) + first + dx, static_cast<std::size_t>(kept) * sizeof(T));
    std::fill(to, to + first, fill);
    std::fill(to + first + kept, to + width, fill);
  }
}

}  // namespace usher::costmap
