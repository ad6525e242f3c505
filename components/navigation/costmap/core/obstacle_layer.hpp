#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/geometry/pose2.hpp"
#include "foundation/grid/grid.hpp"
#include "foundation/result/result.hpp"
#include "navigation/costmap/core/cells.hpp"

namespace usher::costmap {

/// Unit vectors of a scanner's beams in its own frame, computed once per scanner. [x, y] per beam.
std::vector<geometry::Point2> beam_directions(double angle_min, double angle_increment,
                                              std::size_t count);

/// One scan of one sensor.
struct RangeObservation {
  geometry::Pose2 sensor;  ///< in the costmap's frame, at the time of the scan
  std::span<const geometry::Point2> directions;  ///< unit vectors in the sensor's frame
  /// [m] One per direction. A finite positive range is an obstacle at that distance; +infinity is
  /// no echo; everything else (NaN, -infinity, zero, negative) is no measurement, but for a layer
  /// with `negative_clears`. A driver that reports "no echo" as the sensor's maximum range turns it
  /// into infinity, or keeps max_obstacle_range below it.
  std::span<const float> ranges;
  double stamp = 0.0;  ///< [s] any steady origin, the one of update(); finite
  bool clears = true;  ///< else what lies before its echoes stays as it is
};

struct ObstacleLayerConfig {
  std::string name;
  double max_obstacle_range = 2.5;  ///< [m] farther echoes mark nothing
  double min_raytrace_range = 0.0;  ///< [m] cells nearer than this are not cleared
  double max_raytrace_range =
      3.0;  ///< [m] cells farther than this are not cleared; no echo clears so far
  /// [m] {0..1} an echo marks so much behind it too: for a sensor that looks down on low things and
  /// tells of their near edges only.
  double thickness = 0.0;
  /// A finite negative range says that nothing is up to there, and no more: what stands there is
  /// for another layer.
  bool negative_clears = false;
  double persistence =
      0.0;  ///< [s] an obstacle not seen again is forgotten after this time; 0: never
  /// What a line of this scan crosses stays an obstacle while a beam beside its cell's center tells
  /// nothing of it. For a scanner with beams close together, which is blind near it: what stands
  /// there fills a part of its cell only, and the beams that miss it by a hair cross the rest.
  bool clears_only_what_all_beams_pass = false;
  /// [m] {0..1e5, infinity: all} of the robot, in x and y: a recovery keeps what is so near, since
  /// its sensor may not see it again.
  double kept_range = 0.0;
  bool footprint_clearing = true;  ///< where the robot stands there is no obstacle
  /// What this layer saw free hides an obstacle of the static map (thesis 5.2.1). Switch it off for
  /// a sensor that sees through mapped obstacles, for example a laser behind mapped glass.
  bool overrules_static_map = true;
};

/// Obstacles as one sensor sees them: three states per cell of the window. Each sensor has its own
/// layer, so it clears nothing but its own marks (thesis 5.2.2).
class ObstacleLayer {
 public:
  static constexpr std::size_t kMaxBeams = 16384;

  /// An error names the first value of the config that cannot be. Ranges must also stay below 32767
  /// cells.
  static Status check(const ObstacleLayerConfig& config, double resolution);

  /// The config must have passed check().
  ObstacleLayer(ObstacleLayerConfig config, const Raster& raster);

  /// Follows the window: cell (x, y) becomes what (x + dx, y + dy) was.
  void shift(int dx, int dy);

  /// First clears along all beams, then marks all echoes. Returns the rectangle of cells it may
  /// have changed, or why it refused the scan as a whole (then nothing changed). Single invalid
  /// ranges are counted and skipped.
  Result<CellRect> observe(const RangeObservation& observation, const Raster& raster);

  /// Forgets everything and marks the cells of the points (the whisker layer's rule). Points
  /// outside of the window are left out, points that are not finite counted as invalid. Returns the
  /// changed rectangle, or an error (nothing changed) when the stamp is not finite.
  Result<CellRect> replace(std::span<const geometry::Point2> points, double stamp,
                           const Raster& raster);

  /// Forgets obstacles whose persistence is over at `now` (finite). Returns the changed rectangle.
  CellRect expire(double now);
  /// Forgets everything but obstacles in `kept`. Returns the changed rectangle.
  CellRect forget(const CellRect& kept = {});
  /// Forgets obstacles within `reach` [m] of the places (costmap's frame, x and y apart) that a
  /// scan looks beyond, however near they are (min_raytrace_range). Returns the changed rectangle.
  CellRect forget_passed(const RangeObservation& observation,
                         std::span<const geometry::Point2> places, double reach,
                         const Raster& raster);
  /// Forgets obstacles within `reach` [m] of the places (as above) that were marked at `since` [s]
  /// or later; in a layer without persistence, which keeps no times, all. Returns the changed
  /// rectangle.
  CellRect forget_since(double since, std::span<const geometry::Point2> places, double reach,
                        const Raster& raster);
  /// Forgets the obstacles whose cells are not `kept`. Returns the changed rectangle.
  template <class Kept>
  CellRect keep(const Kept& kept) {
    CellRect touched;
    if (!has_obstacles_) return touched;
    has_obstacles_ = false;
    for (int y = seen_.y0; y < seen_.y1; ++y) {
      std::uint8_t* const row = states_.row(y);
      for (int x = seen_.x0; x < seen_.x1; ++x) {
        if (row[x] != kSeenOccupied) continue;
        if (kept(grid::Cell{x, y})) {
          has_obstacles_ = true;
          continue;
        }
        row[x] = kUnseen;
        touched = touched.united({x, y, x + 1, y + 1});
      }
    }
    return touched;
  }
  /// Marks cells of one row as seen free.
  void set_free(int y, int x0, int x1);

  const ObstacleLayerConfig& config() const { return config_; }
  const grid::Grid<std::uint8_t>& states() const { return states_; }
  /// Cells outside of it are unseen.
  const CellRect& seen() const { return seen_; }
  /// Ranges that are none, not what says that nothing is known: NaN.
  std::uint64_t invalid_ranges() const { return invalid_ranges_; }
  /// Scans that cleared nothing since the sensor was outside of the window.
  std::uint64_t sensors_outside() const { return sensors_outside_; }

 private:
  template <class Gone>
  CellRect forget_beside(std::span<const geometry::Point2> places, double reach,
                         const Raster& raster, std::uint8_t state, const Gone& gone);
  CellRect clear_and_collect(const RangeObservation& observation, const Raster& raster);
  bool collect(grid::Cell hit);
  void restore(const RangeObservation& observation, const Raster& raster);
  static bool passed(const RangeObservation& observation, const geometry::Point2& point,
                     double least);
  static bool looks_at(const RangeObservation& observation, const geometry::Point2& point);
  int first_cleared(grid::Cell from, grid::Cell to, double cells_per_meter) const;
  void trace(grid::Cell from, grid::Cell to, int first, bool through);
  void mark(std::size_t index, std::uint32_t time);

  ObstacleLayerConfig config_;
  grid::Grid<std::uint8_t> states_;
  std::vector<std::uint32_t>
      marked_at_;                     // [ms, wraps] of occupied cells; empty without persistence
  std::vector<std::uint32_t> marks_;  // cells of this scan's echoes
  std::vector<std::uint32_t> lost_;   // occupied cells that this scan's lines crossed
  CellRect seen_;
  bool has_obstacles_ = false;  // it may have some
  bool has_deadline_ = false;
  std::uint32_t deadline_ = 0;  // [ms, wraps] no obstacle expires before
  std::uint64_t invalid_ranges_ = 0;
  std::uint64_t sensors_outside_ = 0;
};

}  // namespace usher::costmap
