#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/geometry/footprint.hpp"
#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "navigation/costmap/core/cells.hpp"
#include "navigation/costmap/core/costs.hpp"
#include "navigation/costmap/core/inflation.hpp"
#include "navigation/costmap/core/obstacle_layer.hpp"
#include "navigation/costmap/core/polygon_raster.hpp"
#include "navigation/costmap/core/social_layer.hpp"
#include "navigation/costmap/core/static_layer.hpp"

namespace usher::costmap {

struct CostmapConfig {
  /// A fixed window (rolling = false) lies where this says, usually over the whole map. A rolling
  /// window takes width, height and resolution from it, is centred at the robot and moves by whole
  /// cells of a raster anchored at its frame's origin. Resolution in [0.001, 10] m, at most 2^28
  /// cells.
  grid::GridGeometry window;
  bool rolling = false;
  std::vector<geometry::Point2>
      footprint;                   ///< corners in the base frame [m], see geometry::Footprint
  double inflation_radius = 0.55;  ///< [m] from the footprint's inscribed radius to 120 cells
  double cost_scaling = 10.0;      ///< [1/m] see CostDecay
  Inflation::Unseen unseen =
      Inflation::Unseen::kFree;  ///< what a cell costs that no layer has seen
  int occupied_from = 65;        ///< [%] occupancy of the static map that is an obstacle
  SocialConfig social;           ///< room for people
  cpu::Simd simd = cpu::best_simd();
};

/// A layered costmap (MARVIN thesis 5.2): a static map, one obstacle layer per sensor, combined
/// cell by cell, inflated.
///
/// Per cell: the static map counts where no layer has seen anything; where layers have, the maximum
/// over them (occupied > free > unseen). Layers with overrules_static_map = false join by maximum
/// after that. Then inflation, then the room that people get.
///
/// One cycle: move_to(), observe() for the scans that came, update(). update() redoes what changed
/// since the last call and always gives what a fresh computation would give. No allocation after
/// the first cycle.
class Costmap {
 public:
  using LayerId = std::size_t;
  static constexpr double kMapped = 0.2;  ///< [m] so near to the map's obstacle a thing is that

  /// An error names the first value of the config that cannot be.
  static Result<Costmap> make(CostmapConfig config);

  /// An empty layer for one sensor. An error names the value that cannot be.
  Result<LayerId> add_obstacle_layer(ObstacleLayerConfig config);

  /// The map in its own frame. Without set_static_transform the costmap's frame is the map's frame.
  Status set_static_map(const grid::OccupancyGrid& map);
  /// For example map_T_odom. A changed transform samples the whole window anew.
  Status set_static_transform(const geometry::Pose2& map_T_window);

  /// The robot's pose in the costmap's frame: moves a rolling window, places the footprint. A pose
  /// that is not finite or farther than 1e5 m is refused and changes nothing.
  Status move_to(const geometry::Pose2& base);

  /// Marks and clears the layer's cells by one scan. An error says why the whole scan was refused.
  Status observe(LayerId layer, const RangeObservation& observation);
  /// The whisker layer's rule: forgets the layer and marks the given points (footprint corners
  /// whose whisker is triggered), in the costmap's frame. Such a layer wants footprint_clearing =
  /// false.
  Status replace(LayerId layer, std::span<const geometry::Point2> points, double stamp);
  /// Who gets room, in the costmap's frame, in the place of those before.
  void set_people(std::span<const geometry::Point2> people);
  /// Forgets what the sensors saw and would see again (a recovery). People stay, and the obstacles
  /// of each layer within its kept_range.
  void forget();

  /// Whether a layer has an obstacle within `reach` [m] of a point (in x and y).
  bool beside(LayerId layer, const geometry::Point2& point, double reach) const;
  /// Whether a layer saw that nothing is at a point.
  bool seen_free(LayerId layer, const geometry::Point2& point) const;
  /// Whether a layer has two obstacles within `reach` [m] of a point (in x and y) that are not of
  /// the static map, which has none within kMapped of them: something that may walk away.
  bool unmapped_beside(LayerId layer, const geometry::Point2& point, double reach) const;
  /// Forgets the obstacles of a layer that have none such of another layer beside them: what they
  /// belonged to has gone.
  void keep_beside(LayerId layer, LayerId other, double reach);

  /// Forgets obstacles of a layer within `reach` [m] of one of the places that the scan looks
  /// beyond, however near to the sensor: who stood there walks on.
  void forget_passed(LayerId layer, const RangeObservation& observation,
                     std::span<const geometry::Point2> places, double reach);

  /// Forgets obstacles of a layer within `reach` [m] of the places that were marked at `since` [s]
  /// or later: they were somebody of whom nobody knew yet.
  void forget_since(LayerId layer, double since, std::span<const geometry::Point2> places,
                    double reach);

  /// The costs after all that came since the last call. `now` [s, finite] on the clock of the
  /// observations' stamps; only persistence depends on it. The reference stays valid as long as the
  /// costmap; its content until the next call.
  const grid::Grid<std::uint8_t>& update(double now);

  const grid::Grid<std::uint8_t>& costs() const { return master_; }
  /// Cells that the last update wrote: all when the window moved; the others kept their value.
  const CellRect& changed() const { return changed_; }
  /// Makes the next update compute everything anew.
  void invalidate();

  /// Cost at a point of the costmap's frame; nothing outside of the window (or for NaN).
  std::optional<std::uint8_t> cost_at(const geometry::Point2& point) const;

  const geometry::Footprint& footprint() const { return footprint_; }
  const Raster& raster() const { return raster_; }
  const ObstacleLayer& layer(LayerId id) const { return layers_[id]; }

 private:
  Costmap(CostmapConfig config, geometry::Footprint footprint);
  void touch(const CellRect& cells) { dirty_ = dirty_.united(cells); }
  CellRect around(grid::Cell cell, double reach) const;
  bool unmapped_beside(const ObstacleLayer& layer, grid::Cell cell, double reach) const;
  void clear_footprint();
  void sample_entered(int dx, int dy);
  void combine_row(int y, int x0, int x1);

  CostmapConfig config_;
  geometry::Footprint footprint_;
  Raster raster_;
  StaticLayer static_layer_;
  geometry::Pose2 map_T_window_;
  grid::Grid<std::uint8_t> static_states_;
  bool static_stale_ = true;  // the whole window is to be sampled anew
  std::vector<ObstacleLayer> layers_;
  Inflation inflation_;
  SocialLayer social_;
  grid::Grid<std::uint8_t> master_;
  std::optional<geometry::Pose2> base_;
  CellRect dirty_;
  CellRect changed_;
};

}  // namespace usher::costmap
