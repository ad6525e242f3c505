#pragma once

#include <cstdint>
#include <span>

#include "foundation/grid/grid.hpp"

namespace usher::meeting {

using geometry::Point2;

/// Where the laser looked through a moment ago. What stands there now has walked there: somebody,
/// whether or not a camera sees the face.
class ClearedSpace {
 public:
  /// Covers what this map does; nothing was looked through yet.
  void set_extent(const grid::GridGeometry& map);
  /// Nothing was looked through.
  void forget();

  /// A scan from a place in map: up to 0.2 m before each of its points nothing stood. Points that
  /// are not finite are nothing. O(points x length), no allocation.
  void add(const Point2& from, std::span<const Point2> points);
  /// Three scans or more looked through there and through what lies 0.15 m around it (no wall is so
  /// thin), and few met something there.
  bool was_clear(const Point2& point) const;
  /// Three scan points or more lay within 0.25 m of it: who stands there has stood there before.
  bool was_taken(const Point2& point) const;

 private:
  struct Looked {
    std::uint32_t last = 0;   ///< number of the last scan that looked through; 0: none did
    std::uint32_t scans = 0;  ///< so many did
    std::uint32_t met = 0;    ///< points that lay there
  };
  grid::Grid<Looked> cells_;
  std::uint32_t scan_ = 0;
};

}  // namespace usher::meeting
