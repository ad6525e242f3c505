#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"

namespace usher::movement_control {

/// A window of costs around the robot, as costmap_2d has them.
struct CostsView {
  std::span<const std::uint8_t> costs;  ///< row-major from the lower-left cell; 254 is lethal
  std::size_t width = 0, height = 0;    ///< [cells]
  double resolution = 0.0;              ///< [m]
  geometry::Point2 origin = geometry::Point2::Zero();  ///< [m] lower-left corner
};

/// Where costs near the robot are lethal: what no laser sees is there, too. Allocates when made
/// only.
class LethalCells {
 public:
  LethalCells();

  /// Centers of the lethal cells within `reach` [m] of the robot, in base_footprint; the thing in a
  /// cell may be half a cell nearer. At most 4096, the window's rows nearest to the robot first.
  /// None where the window is none, or does not hold the robot. Valid until the next call.
  std::span<const geometry::Point2> around(const geometry::Pose2& window_T_base,
                                           const CostsView& window, double reach);

 private:
  /// The raster of the window, in base_footprint.
  struct Raster {
    geometry::Point2 first, column, row;  ///< [m] center of the first cell; from one to the next
  };

  void take_row(const CostsView& window, const Raster& raster, std::size_t row, double from,
                double to);

  std::vector<geometry::Point2> cells_;
};

}  // namespace usher::movement_control
