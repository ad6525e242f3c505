#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "foundation/grid/grid.hpp"
#include "navigation/costmap/core/costs.hpp"
#include "navigation/costmap/core/polygon_raster.hpp"

namespace usher::costmap {

/// What lies under a footprint.
struct FootprintReading {
  std::uint8_t highest_cost = 0;  ///< of the known cells; kLethalCost is contact
  bool touches_unknown = false;
  bool leaves_grid = false;  ///< a part is outside of the grid, where nothing is known

  bool operator==(const FootprintReading&) const = default;
};

/// Reads all cells of a cost grid that the footprint touches at a pose in the grid's frame. A pose
/// that is not finite reads as outside of the grid.
inline FootprintReading footprint_reading(const grid::Grid<std::uint8_t>& costs,
                                          std::span<const geometry::Point2> footprint,
                                          const geometry::Pose2& pose) {
  FootprintReading reading;
  if (!pose.finite() || costs.empty()) {
    reading.leaves_grid = true;
    return reading;
  }
  const PolygonRaster raster(footprint, pose, costs.geometry());
  reading.leaves_grid = raster.leaves_grid();
  raster.for_each_span([&](const CellSpan& span) {
    const std::uint8_t* row = costs.row(span.y);
    for (int x = span.x0; x < span.x1; ++x) {
      if (row[x] == kUnknownCost) {
        reading.touches_unknown = true;
      } else {
        reading.highest_cost = std::max(reading.highest_cost, row[x]);
      }
    }
  });
  return reading;
}

}  // namespace usher::costmap
