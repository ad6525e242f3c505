#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::grid {

/// A cell by column (x) and row (y); row 0 is the bottom row (smallest y).
struct Cell {
  int x = 0;
  int y = 0;
  bool operator==(const Cell&) const = default;
};

/// Where a grid lies in its frame: axis-aligned, cell (0,0) has its lower-left corner at the
/// origin.
struct GridGeometry {
  int width = 0;            ///< [cells]
  int height = 0;           ///< [cells]
  double resolution = 0.0;  ///< [m] side of a cell
  double origin_x = 0.0;    ///< [m] lower-left corner of cell (0,0)
  double origin_y = 0.0;    ///< [m]

  bool contains(Cell c) const { return c.x >= 0 && c.y >= 0 && c.x < width && c.y < height; }
  std::size_t size() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t index(Cell c) const {
    return static_cast<std::size_t>(c.y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(c.x);
  }
  Cell cell(std::size_t index) const {
    const auto w = static_cast<std::size_t>(width);
    return {static_cast<int>(index % w), static_cast<int>(index / w)};
  }
  /// The cell that holds a point; it may lie outside the grid: ask contains(). The point must be
  /// finite and its cell must fit an int.
  Cell cell_at(double x, double y) const {
    return {static_cast<int>(std::floor((x - origin_x) / resolution)),
            static_cast<int>(std::floor((y - origin_y) / resolution))};
  }
  Cell cell_at(const geometry::Point2& p) const { return cell_at(p.x(), p.y()); }
  geometry::Point2 center(Cell c) const {
    return {origin_x + (c.x + 0.5) * resolution, origin_y + (c.y + 0.5) * resolution};
  }
  bool operator==(const GridGeometry&) const = default;
};

/// Values on a grid, row-major from the lower-left cell, x fastest (the layout of
/// nav_msgs/OccupancyGrid).
template <class T>
class Grid {
 public:
  Grid() = default;
  explicit Grid(const GridGeometry& geometry, T value = T{})
      : geometry_(geometry), values_(geometry.size(), value) {}

  const GridGeometry& geometry() const { return geometry_; }
  /// Moves the grid in its frame; the values stay in their cells.
  void set_origin(double x, double y) { geometry_.origin_x = x, geometry_.origin_y = y; }
  int width() const { return geometry_.width; }
  int height() const { return geometry_.height; }
  double resolution() const { return geometry_.resolution; }
  bool empty() const { return values_.empty(); }
  std::size_t size() const { return values_.size(); }

  T& operator[](std::size_t index) { return values_[index]; }
  const T& operator[](std::size_t index) const { return values_[index]; }
  T& at(Cell c) { return assert(geometry_.contains(c)), values_[geometry_.index(c)]; }
  const T& at(Cell c) const { return assert(geometry_.contains(c)), values_[geometry_.index(c)]; }
  /// The value of a cell, or `outside` for a cell beyond the border.
  T value_or(Cell c, T outside) const {
    return geometry_.contains(c) ? values_[geometry_.index(c)] : outside;
  }

  T* data() { return values_.data(); }
  const T* data() const { return values_.data(); }
  T* row(int y) { return values_.data() + geometry_.index({0, y}); }
  const T* row(int y) const { return values_.data() + geometry_.index({0, y}); }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  std::vector<T>& values() { return values_; }
  const std::vector<T>& values() const { return values_; }
  bool operator==(const Grid&) const = default;

 private:
  GridGeometry geometry_;
  std::vector<T> values_;
};

/// Occupancy in percent as in nav_msgs/OccupancyGrid: 0 free .. 100 occupied, -1 unknown.
using OccupancyGrid = Grid<std::int8_t>;
inline constexpr std::int8_t kUnknown = -1;
inline constexpr std::int8_t kFree = 0;
inline constexpr std::int8_t kOccupied = 100;

}  // namespace usher::grid
