#pragma once

#include <cstdint>
#include <vector>

#include "foundation/random/random.hpp"
#include "simulation/world/core/depth_cameras.hpp"
#include "simulation/world/core/ray_caster.hpp"

namespace usher::world {

/// What the depth pipeline makes of a camera's images, without the images: for missions that shall
/// run much faster than real time. The constants are fitted to the rendered chain;
/// tests/simulation/depth_chain_test.cpp compares the two.
struct DepthScanModelConfig {
  rendering::Lens lens = rendering::kinect_v2().lens;
  double widest = 0.85;      ///< the scan's bearings cover columns seen at this share of forward
  double least_depth = 0.5;  ///< [m] along the optical axis
  double max_range = 5.0;    ///< [m] of the scan
  double origin = 0.20;      ///< [m] of the scan ahead of the axle in the camera's direction
  // The pipeline's threshold of height over the floor: margin + angle times distance + growth times
  // its square.
  double floor_margin = 0.024;
  double floor_angle = 0.0065;
  double floor_growth = 0.0;
  double ceiling = 2.0;          ///< [m]
  double low_height = 0.45;      ///< [m]
  double low_gap = 0.4;          ///< [m]
  double drop_range = 4.0;       ///< [m]
  double low_from = 1.8;         ///< [m] the floor must be in the image from there on
  double noise = 0.004;          ///< [m] standard deviation of a range, at 0 m
  double noise_growth = 0.0015;  ///< [1/m] and its growth with the square of the range
  double body_radius = 1.0;      ///< of a person, times the disc that the crowd uses
  double lost = 0.002;           ///< share of bearings without a measurement
};

/// Ranges over equal steps of bearing, counter-clockwise; +infinity free, NaN not known.
struct DepthScanResult {
  double angle_min = 0.0;     ///< [rad]
  double increment = 0.0;     ///< [rad]
  std::vector<float> ranges;  ///< [m] nearest obstacle or missing floor
  std::vector<float> low;     ///< [m] what is lower than low_height, alone; -r: none up to r
};

/// The same for a pipeline that fits the floor in every frame: low things count from what the noise
/// of the floor leaves.
inline DepthScanModelConfig with_fitted_floor(DepthScanModelConfig config) {
  config.floor_margin = 0.003;
  config.floor_angle = 0.0;
  config.floor_growth = 0.0014;
  return config;
}

class DepthScanModel {
 public:
  DepthScanModel(const DepthScanModelConfig& config, std::uint64_t seed);

  /// The scan of a camera now. About 60 us; no allocation while the scene stays the same.
  void scan(const World& world, const DepthCamera& camera, DepthScanResult& result);

 private:
  void choose_heights(const Scene& scene, double feet);
  void cast(const World& world, const Pose2& camera, double height);
  bool in_view(double forward, double height) const;
  double depth_of(double forward, double height) const;
  void disturb(double burst, DepthScanResult& result);

  DepthScanModelConfig config_;
  Random random_;
  Fan fan_;
  RayCaster caster_;
  FanHits hits_;
  std::vector<std::uint8_t> see_through_;  // glass, for each beam
  std::vector<Mover> movers_;
  std::vector<double> heights_;
  std::uint64_t version_ = 0;
  double feet_ = 0.0;  // [m] that the heights are chosen for
  double camera_height_ = 0.0, down_ = 0.0;
  std::vector<float> high_, low_;
  std::vector<std::uint8_t>
      hidden_;  // bearings where what is too near to be measured fills the image
};

}  // namespace usher::world
