#pragma once

#include <cstdint>
#include <vector>

#include "foundation/random/random.hpp"
#include "simulation/world/core/depth_cameras.hpp"
#include "simulation/world/core/ray_caster.hpp"

namespace usher::world {

/// Which faces the face detector finds in a camera's images, without the images: for missions that
/// shall run much faster than real time. Sizes, distances and the share of missed faces are those
/// of the rendered chain (`usher experiment depth-model`); how false faces come is ours.
struct FaceModelConfig {
  rendering::Lens lens = rendering::kinect_v1().lens;
  double nearest = 0.4;         ///< [m] along the optical axis
  double farthest = 3.5;        ///< [m]
  double side = 0.16;           ///< [m] of the rectangle
  double turned = 0.6;          ///< [rad] a face that looks farther past the camera is not found
  double missed = 0.03;         ///< share of images in which a face that is plainly seen is missed
  double false_alarms = 0.001;  ///< faces per image that are none
  double again = 0.3;           ///< share of those that the next image has, too
  double pixels = 1.5;          ///< [pixels] standard deviation of the rectangle's middle
  double side_spread = 0.04;    ///< of its side, relative
  double depth_spread = 0.008;  ///< of the depth, relative
};

/// A face as the detector tells it; range, bearing, elevation are in base_footprint.
struct ModelledFace {
  double left = 0.0, top = 0.0, side = 0.0;  ///< [pixels]
  double depth = 0.0;                        ///< [m] along the optical axis
  double range = 0.0;                        ///< [m] along the floor
  double bearing = 0.0;                      ///< [rad]
  double elevation = 0.0;                    ///< [m] above the floor
};

class FaceModel {
 public:
  FaceModel(const FaceModelConfig& config, std::uint64_t seed);

  /// The faces that the detector would find in an image of this camera now, the nearest first; at
  /// most 32. Deterministic for the seed and the calls; no allocation after the first ones.
  void find(const World& world, const DepthCamera& camera, std::vector<ModelledFace>& faces);

 private:
  bool hidden(const World& world, std::size_t person, const Eigen::Vector3d& camera,
              const Eigen::Vector3d& face);
  /// Where that pixel at that depth lies; nothing where the rectangle is not wholly in the image.
  bool tell(const World& world, const geometry::Pose3& camera, double column, double row,
            double side, double depth, std::vector<ModelledFace>& faces) const;

  FaceModelConfig config_;
  Random random_;
  Fan sight_;
  RayCaster caster_;
  FanHits hits_;
  std::vector<std::uint8_t> see_through_;  // glass, for each beam
  std::vector<Mover> others_;
  struct False {
    double column, row, depth;
  };
  std::vector<False> false_;  // of the last image
};

}  // namespace usher::world
