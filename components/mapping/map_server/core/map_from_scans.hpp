#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"

namespace usher::map_server {

struct MappingParameters {
  double resolution = 0.05;  ///< [m]
  double max_range = 30.0;   ///< [m] readings from here on saw nothing and leave no trace
  double occupied_share =
      0.25;  ///< a cell is occupied when at least this share of the beams that met it ended in it
  std::size_t max_cells = std::size_t{1} << 26;
};

/// A planar scan from a known place.
struct PlacedScan {
  geometry::Pose2 map_T_laser;
  double angle_min = 0.0;         ///< [rad]
  double angle_increment = 0.0;   ///< [rad]
  std::span<const float> ranges;  ///< [m]
};

/// Counts, for every cell, beams that ended in it and beams that passed through it, and makes a map
/// of the counts
/// ("counting model" [thrun2005, chapter 9]). The grid grows with the scans; cells are aligned with
/// multiples of the resolution, so the order of the scans does not matter. O(cells crossed) a beam.
class MapFromScans {
 public:
  explicit MapFromScans(const MappingParameters& parameters);

  /// Refuses (and ignores) a scan whose pose or angles are not finite, or which would let the map
  /// grow beyond max_cells. Readings that are not finite, not positive or at max_range and beyond
  /// are left out.
  Status add(const PlacedScan& scan);

  /// Free, occupied and unknown cells, cropped to what was seen with a border of one unknown cell.
  /// Empty before the first beam.
  grid::OccupancyGrid map() const;

 private:
  struct Counts {
    std::uint32_t ended = 0;
    std::uint32_t passed = 0;
  };

  bool make_room(const geometry::Point2& low, const geometry::Point2& high);

  MappingParameters parameters_;
  grid::Grid<Counts> counts_;
};

}  // namespace usher::map_server
