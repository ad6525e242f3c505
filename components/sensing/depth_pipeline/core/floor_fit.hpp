#pragma once

#include <optional>

#include "sensing/depth_pipeline/core/camera.hpp"

namespace usher::depth_pipeline {

struct FloorFitConfig {
  double reach = 3.5;         ///< [m] {0.5..6} floor farther away is not used
  double band = 0.03;         ///< [m] {0.002..0.2} first guess of what is floor, at the camera
  double band_growth = 0.02;  ///< [-] {0..0.1} and how it widens with distance
  double narrowest = 0.008;   ///< [m] {0.001..0.1} band of the last pass
  int least_samples = 120;    ///< {10..} fewer are no floor
  double max_height = 0.05;   ///< [m] {0..0.3} larger corrections are refused
  double max_angle = 0.035;   ///< [rad] {0..0.2} larger corrections are refused
};

/// What one frame says of the floor: the camera's pose over it.
struct FloorFit {
  CameraPose pose;
  int samples = 0;
  double residual = 0.0;  ///< [m] root mean square of the heights
};

/// Fits the floor to the pixels near the predicted one: three passes of least squares over every
/// twelfth column and fourth row with a narrowing band. Corrects height, pitch and roll of the
/// prediction by what a wheel on a cable or a wrong calibration adds; nothing when too little floor
/// is visible or the correction would be larger than a correction may be. About 50 us, no
/// allocation.
std::optional<FloorFit> fit_floor(const DepthImage& image, const Intrinsics& intrinsics,
                                  const CameraPose& predicted, const FloorFitConfig& config);

}  // namespace usher::depth_pipeline
