#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "navigation/costmap/core/cells.hpp"

namespace usher::costmap {

/// How much room people get where there is room: the far end of personal space
/// [hall1966dimension].
struct SocialConfig {
  double radius = 1.2;     ///< [m] {0..3} around a person's middle; 0: none
  std::uint8_t cost = 80;  ///< {0..252} at the middle, from where it falls evenly; never a bar
};
Status check(const SocialConfig& config);

/// Costs of being near to people. They lie over the inflated obstacles, cell by cell the higher of
/// both, and stay below what bars a way.
class SocialLayer {
 public:
  static constexpr std::size_t kMost = 64;  ///< people; more are left out

  explicit SocialLayer(const SocialConfig& config) : config_(config) {}

  /// Everybody, in the costmap's frame, in the place of those before; who is not finite is left
  /// out. Returns the cells of the window that may change.
  CellRect set(std::span<const geometry::Point2> people, const Raster& raster);

  /// Raises the costs of a window near people. O(cells near people), no allocation.
  void paint(const Raster& raster, grid::Grid<std::uint8_t>& master) const;

  /// The cost at a distance [m] from somebody.
  std::uint8_t at(double distance) const;

 private:
  CellRect cells_around(const geometry::Point2& person, const Raster& raster) const;
  CellRect cells_of_all(const Raster& raster) const;

  SocialConfig config_;
  std::vector<geometry::Point2> people_;
};

}  // namespace usher::costmap
