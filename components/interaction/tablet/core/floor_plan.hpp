#pragma once

#include <cstdint>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"

namespace usher::tablet {

enum class Ground : std::uint8_t { kUnknown, kFloor, kWall };

/// The building as a picture, north up, cut to what is known of it.
struct FloorPlan {
  int width = 0, height = 0;          ///< [px]; one pixel is one cell
  std::vector<std::uint32_t> pixels;  ///< 0xffRRGGBB, row-major from the upper left
  double resolution = 0.05;           ///< [m] of a pixel
  geometry::Point2 upper_left{0, 0};  ///< [m] in map

  bool empty() const { return pixels.empty(); }
  /// What a pixel of the picture shows.
  Ground ground(int x, int y) const;
  /// From map to pixels of the picture, which may be scaled: `scale` is its pixels for one of ours.
  geometry::Point2 to_pixels(const geometry::Point2& point_in_map, double scale) const {
    return {(point_in_map.x() - upper_left.x()) / resolution * scale,
            (upper_left.y() - point_in_map.y()) / resolution * scale};
  }
};

/// Walls (at least 65 % occupied) light, floor grey, unknown as the background. Unknown margins are
/// cut off but for `margin` cells. Empty for a map without a known cell.
FloorPlan draw_floor_plan(const grid::OccupancyGrid& map, int margin);

/// The points of a path that matter for a picture: nothing is farther than `tolerance` [m] from the
/// original (Ramer, Douglas, Peucker).
std::vector<geometry::Point2> simplified(const std::vector<geometry::Point2>& path,
                                         double tolerance);

}  // namespace usher::tablet
