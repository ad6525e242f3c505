#pragma once

#include <cstdint>
#include <vector>

#include "sensing/depth_pipeline/core/camera.hpp"

namespace usher::depth_pipeline {

/// What counts as floor and ceiling. A point is an obstacle when it is higher than
///
///     floor_margin + angle_margin z + noise_factor k (noise_base + noise_growth z^2 + grazing)
///     grazing = noise_grazing z^1.5 (t / (pi/2 - t))^2
///
/// at distance z, where k is the height that a metre of depth is worth in its row: the
/// distance-dependent threshold of thesis figure 4.16, said in height. Where a level floor is
/// looked at along it, under an angle t from upright, its depth is noisier than that of things that
/// stand [fankhauser2015kinect]: what is too flat for its distance is not told from floor.
struct FloorModel {
  double floor_margin = 0.02;    ///< [m] {0..0.5} floors and calibrations are not exact
  double angle_margin = 0.006;   ///< [rad] {0..0.1} error of pitch and tilt
  double noise_factor = 3.0;     ///< [-] {0..10} standard deviations
  double noise_base = 0.0011;    ///< [m] {0..0.1} standard deviation of the depth at 0 m
  double noise_growth = 0.0002;  ///< [1/m] {0..0.05} and its growth with the square of z
  double noise_grazing = 0.0;    ///< [m^-0.5] {0..0.001} and that of a floor looked at along it
  double ceiling = 2.0;          ///< [m] {0.3..4} higher things do not concern the robot
  double low_height = 0.45;      ///< [m] {0..2} lower things leave the image near the robot
  double drop_depth = 0.08;      ///< [m] {0.02..1} deeper below the floor than this is a drop
  double drop_range = 4.0;       ///< [m] {0..6} where drops are looked for; 0: nowhere
};

Status check(const FloorModel& model);

/// The same for a camera that measures by structured light, as a Kinect v1: its depth is noisier by
/// far with distance [nguyen2012kinect] and comes in steps [khoshelham2012kinect].
FloorModel for_structured_light(FloorModel model);

/// Limits of one row (in one strip of columns) in millimetres of depth.
struct RowLimits {
  std::uint16_t obstacle = 0;  ///< depths up to this are obstacles: nearer than floor and ceiling
  std::uint16_t high = 0;      ///< depths up to this are higher than low_height
  std::uint16_t fall = 0;      ///< depths from this on lie below the floor
  /// Distance of the floor from the camera's foot [mm]; 0: drops are not looked for in this row.
  std::uint16_t floor = 0;
};

/// What all columns of a row have in common.
struct RowScale {
  /// Horizontal distance of a point per depth, in 1/32768: cos(down) - y sin(down).
  std::uint16_t forward = 0;
};

/// The predicted ground and ceiling planes (thesis 4.10 to 4.20, with c = h / cos(pitch)), row by
/// row, for one camera pose. With a roll the image is cut into strips of columns, each with rows of
/// its own.
class FloorPrediction {
 public:
  static constexpr int kStrips = 8;         ///< of an image with roll
  static constexpr int kMaxDepth = 0x3fff;  ///< [mm] nothing farther counts

  /// `max_depth` [m]: farther pixels are background.
  FloorPrediction(const Intrinsics& intrinsics, const FloorModel& model, double max_depth);

  /// No allocation. About 5 us, 40 us with a roll.
  void predict(const CameraPose& pose);

  int strips() const { return strips_; }
  /// Rows from the top, for the columns [first_column(strip), first_column(strip + 1)).
  const RowLimits* rows(int strip) const {
    return limits_.data() + static_cast<std::size_t>(strip) * scales_.size();
  }
  const RowScale* scales() const { return scales_.data(); }
  /// A multiple of 16; the last is the width, rounded up to one.
  int first_column(int strip) const;
  /// Predicted depth of the floor [m] in a row, of the middle column; infinity above the horizon.
  double floor_depth(int row) const;
  const CameraPose& pose() const { return pose_; }

 private:
  double grazing(double slope, double forward) const;
  RowLimits limits_of(double slope, double forward) const;

  Intrinsics intrinsics_;
  FloorModel model_;
  double max_depth_;
  CameraPose pose_;
  int strips_ = 1;
  std::vector<RowLimits> limits_;
  std::vector<RowScale> scales_;
};

}  // namespace usher::depth_pipeline
