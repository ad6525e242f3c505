#pragma once

#include <cstdint>
#include <vector>

#include "foundation/random/random.hpp"
#include "simulation/rendering/core/renderer.hpp"

namespace usher::rendering {

/// What a kind of depth camera makes of true distances.
struct DepthSensorConfig {
  enum class Noise {
    kTimeOfFlight,     ///< Kinect v2 [fankhauser2015kinect]
    kStructuredLight,  ///< Kinect v1 [nguyen2012kinect], in steps [khoshelham2012kinect]
  };
  Lens lens;
  Noise noise = Noise::kTimeOfFlight;
  double least = 0.5;           ///< [m] nearer surfaces return nothing
  double most = 8.0;            ///< [m] farther ones neither
  double dropouts = 0.015;      ///< share of pixels that return nothing
  double dark_dropouts = 0.5;   ///< the same on dark surfaces
  double grazing = 0.17;        ///< cosine of the flattest view that returns anything (80 deg)
  double flying = 0.25;         ///< share of pixels at an edge that lie between both surfaces
  double shadow = 0.0;          ///< [m] base of the projector: pixels it does not reach are lost
  double mirror_share = 0.25;   ///< of the patches of vinyl that mirror at grazing angles
  double mirror_cosine = 0.42;  ///< flatter views of vinyl may mirror (65 deg)
  double mirror_patch = 0.12;   ///< [m] size of a patch that mirrors
};

DepthSensorConfig kinect_v2();
DepthSensorConfig kinect_v1();
/// The camera that looks back: structured light of half the resolution.
DepthSensorConfig rear_camera();

/// Depth images with the errors of a camera: noise by distance and angle, holes, mirrored surfaces,
/// pixels between two surfaces, and bursts of noise when the pitch jumps. Deterministic for its
/// seed.
class DepthSensor {
 public:
  DepthSensor(const DepthSensorConfig& config, std::uint64_t seed);

  const DepthSensorConfig& config() const { return config_; }

  /// One image in millimetres, 0 = nothing. `burst` in [0, 1] is how much of the image the jump of
  /// the pitch spoils. No allocation after the first call.
  void measure(Renderer& renderer, const geometry::Pose3& world_T_camera, double burst,
               std::vector<std::uint16_t>& millimeters);

  /// What the last image's rays really met.
  const Hits& truth() const { return hits_; }

 private:
  float gaussian() { return gaussian_[random_.next() & (gaussian_.size() - 1)]; }
  float sigma(float depth, float cosine) const;
  void mirror(Renderer& renderer, const geometry::Pose3& world_T_camera);
  void lose_shadows();
  void add_noise(std::vector<std::uint16_t>& millimeters);
  void add_burst(double burst, std::vector<std::uint16_t>& millimeters);
  bool patch_mirrors(double x, double y) const;

  DepthSensorConfig config_;
  std::uint64_t seed_;
  Random random_;
  std::vector<float> gaussian_;
  std::vector<float> by_angle_;  // growth of the noise over the cosine
  Hits hits_;
  std::vector<float> seen_;  // [m] depth after mirrors
};

/// The image of a colour camera, 3 bytes a pixel: things by their material, people by their number,
/// shaded by the angle.
void paint(const Hits& hits, std::vector<std::uint8_t>& rgb);

}  // namespace usher::rendering
