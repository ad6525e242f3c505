#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "foundation/cpu/cpu.hpp"
#include "foundation/result/result.hpp"
#include "sensing/depth_pipeline/core/camera.hpp"
#include "sensing/depth_pipeline/core/confidence.hpp"
#include "sensing/depth_pipeline/core/floor_fit.hpp"
#include "sensing/depth_pipeline/core/row_limits.hpp"

namespace usher::depth_pipeline {

// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): in the order of the pipeline's steps
struct PipelineConfig {
  FloorModel floor;
  double min_depth = 0.4;    ///< [m] {0.05..2} nearer pixels measured nothing
  double max_depth = 8.0;    ///< [m] {1..16} farther ones are background
  double max_range = 5.0;    ///< [m] {0.5..16} farther obstacles are not in the scan
  bool opening = true;       ///< erode and dilate by 3 x 3 (thesis: MORPH_OPEN): fills holes
  double origin = 0.2;       ///< [m] of the scan, ahead of the axle in the camera's direction
  int support = 3;           ///< {1..8} neighbouring bearings that must agree on an obstacle
  double support_gap = 0.3;  ///< [m] {0..} within which they agree
  double low_gap = 0.4;      ///< [m] {0..} what stands so near before something high is part of it
  /// [m] {0..0.5} across that something low must measure. Pixels at an edge lie anywhere between
  /// the edge and the floor behind it: a few bearings of low things that nobody will see again.
  double low_width = 0.04;
  double low_step = 0.06;  ///< [m] {0..} of range between two bearings of one low thing
  /// Floor that gives no measurement counts as missing, in a column that measures something.
  bool missing_is_drop = true;
  double drop_length = 0.3;  ///< [m] {0.05..2} of floor that must be missing along a column
  double drop_width = 0.2;   ///< [m] {0..2} and across
  /// [m] {0..2} across where the floor is looked at flatter than 62 deg: vinyl mirrors in patches
  /// there, which look like holes.
  double grazing_drop_width = 0.4;
  int confidence_frames = 3;          ///< {1..8} of the rolling mean
  double confidence_threshold = 0.5;  ///< [m] {0.01..10} deviation with confidence 0
  double least_confidence = 0.2;      ///< {0..1} ranges with less become NaN
  double lasting_confidence = 0.8;    ///< {0..1} the same in `low`, which others remember
  /// [m] {0..8} only an image that shows the floor from there on tells that nothing low is there: a
  /// camera that looks elsewhere sees nothing of it.
  double low_from = 1.8;
  double least_measured = 0.02;  ///< {0..1} a smaller share of pixels is a blind camera's
  bool refit = false;            ///< fit the floor in each frame; then floor_margin may be small
  FloorFitConfig fit;
  FloorModel refitted{.floor_margin = 0.003, .angle_margin = 0.0006, .noise_grazing = 1e-4};
  cpu::Simd simd = cpu::best_simd();
};

/// The error names the first value that cannot be.
Status check(const PipelineConfig& config);

/// Ranges over equal steps of bearing, counter-clockwise from angle_min. +infinity: free, NaN: not
/// known.
struct ScanGeometry {
  double angle_min = 0.0;  ///< [rad]
  double increment = 0.0;  ///< [rad]
  std::size_t count = 0;
};

/// What a range of a low scan ends at.
enum class Drop : std::uint8_t {
  kNone,         ///< a thing
  kMissing,      ///< missing floor; what hides it may be too near to be measured
  kBehindFloor,  ///< missing floor behind floor that the same column shows: nothing hides it
};

struct DepthScan {
  std::vector<float> ranges;       ///< [m] horizontal, from the scan's origin
  std::vector<float> intensities;  ///< {0..1} confidence
};

/// What became of one frame; views stay valid until the next.
struct DepthView {
  std::span<const std::uint16_t> processed;  ///< [mm] obstacles only, 0 elsewhere
  const DepthScan* scan = nullptr;           ///< nearest obstacle or drop of each bearing
  /// Only what is lower than low_height, and drops; -r: nothing low up to r [m], where something
  /// high hides it.
  const DepthScan* low = nullptr;
  std::span<const Drop> low_drops;  ///< of each bearing of `low`
  CameraPose pose;                  ///< as used: refitted when `refitted`
  bool refitted = false;
  int drops = 0;          ///< columns that end at missing floor
  double measured = 0.0;  ///< {0..1} share of the pixels that measured something
};

/// From depth images to scans and images of obstacles (thesis 4.4.1, equations 4.8 to 4.23).
///
/// Differences from the thesis, each for a reason in the README: pinhole rays instead of equal
/// angles per row and column, horizontal ranges that heed the pitch, two pixels to an obstacle,
/// regular bearings, missing floor as an obstacle, 16 bits. No allocation after construction;
/// usher bench depth measures a frame's time.
class DepthPipeline {
 public:
  static Result<DepthPipeline> make(const Intrinsics& intrinsics, const PipelineConfig& config);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  const PipelineConfig& config() const { return config_; }
  const ScanGeometry& geometry() const { return geometry_; }

  /// `pose` is the camera's at the frame's time. An image of another size or a pose that cannot be
  /// (not finite, height outside [0.05, 3] m, steeper than 1.2 rad) is refused with the reason, and
  /// nothing changes.
  Result<DepthView> process(const DepthImage& image, const CameraPose& pose);

  /// Before an image that does not follow the last one (a gap, a turn of the camera): what it
  /// measures is not confirmed by those of another place.
  void forget_frames();

 private:
  DepthPipeline(const Intrinsics& intrinsics, const PipelineConfig& config);

  void sort_pixels(const DepthImage& image, const FloorPrediction& floor);
  double measured_share() const;
  void clear_bearings();
  void forget_blind_falls(const FloorPrediction& floor);
  void mark_feet(const DepthImage& image, const CameraPose& pose);
  int mark_drops(const DepthImage& image, const CameraPose& pose);
  void mark_seen(const CameraPose& pose);
  void mark_obstacles(const DepthImage& image, const CameraPose& pose,
                      const FloorPrediction& floor);
  double measured_between(const DepthImage& image, int column, double from, double to) const;
  bool measured_over(const DepthImage& image, int column, double row) const;
  bool seen_above(const DepthImage& image, const CameraPose& pose, int column, double row) const;
  double row_of_high(const CameraPose& pose, double depth) const;
  double row_of_horizon(const CameraPose& pose) const;
  double row_of_floor(const CameraPose& pose, double forward) const;
  double nearest_floor(const CameraPose& pose) const;
  void add_low();
  void tell_drops();
  void tell_where_nothing_low_is(const CameraPose& pose);
  void drop_unsupported(std::vector<float>& ranges) const;
  void mark(std::vector<float>& ranges, int column, double forward, double side_per_pixel);
  std::size_t bearing_of(double forward, double left) const;
  std::pair<std::size_t, std::size_t> bearings_of(int column, double forward,
                                                  double side_per_pixel) const;

  Intrinsics intrinsics_;
  PipelineConfig config_;
  ScanGeometry geometry_;
  FloorPrediction predicted_, refitted_;
  std::vector<std::uint16_t> processed_;
  std::vector<std::uint16_t> columns_;  // eleven rows of kernels::Columns
  std::vector<std::uint16_t> buffers_;
  std::size_t column_stride_ = 0;
  std::size_t buffer_stride_ = 0;
  double shift_ = 0.0;  // [m] from the scan's origin to the camera's foot
  DepthScan scan_, low_;
  std::vector<float> seen_low_;  // [m] of each bearing, NaN: nothing low
  /// [m] of each bearing: what is high, its foot, and what may be one. Both are in one column and
  /// not always at one bearing, where the camera looks down: at the image's edge the foot alone is.
  std::vector<float> tall_;
  std::vector<float> fallen_;  // [m] of each bearing: where floor is missing that low_ tells of
  std::vector<float> fallen_behind_floor_;  // [m] of each bearing: the same, nothing hides it
  std::vector<Drop> low_drops_;
  std::vector<std::uint16_t> floor_ends_;   // [mm] of each column, hidden or not
  std::vector<std::uint8_t> behind_floor_;  // of each column: floor is missing behind floor
  std::vector<std::uint8_t> looked_;  // of each bearing, whether its columns measured something
  mutable std::vector<float> spare_;
  Confidence confidence_, low_confidence_;
};

}  // namespace usher::depth_pipeline
