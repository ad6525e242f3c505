#pragma once

#include <cstdint>
#include <vector>

#include "foundation/imaging/appearance.hpp"
#include "foundation/random/random.hpp"
#include "simulation/world/core/depth_cameras.hpp"
#include "simulation/world/core/ray_caster.hpp"

namespace usher::world {

/// Whom the people detector finds in a camera's images, without the images: for missions that shall
/// run much faster than real time. The constants are fitted to the rendered chain;
/// tests/simulation/people_chain_test.cpp compares the two.
struct PeopleModelConfig {
  rendering::Lens lens = rendering::kinect_v2().lens;
  double origin = 0.20;   ///< [m] where sightings are seen from, ahead of the axle in the camera's
                          ///< direction
  double nearest = 0.4;   ///< [m] along the optical axis
  double farthest = 6.3;  ///< [m]
  double likely_area = 0.075;   ///< [m^2] visible of a body that is found every second time
  double area_slope = 0.02;     ///< [m^2] by which that rises to 73 %
  double missed = 0.01;         ///< share of images in which who is plainly visible is missed
  double filled = 0.62;         ///< share of the upright cylinder that a body fills
  double along = 0.04;          ///< [m] standard deviation along the line of sight
  double across = 0.05;         ///< [m] and beside it
  double height = 0.05;         ///< [m] and of the highest point
  double least_clothes = 0.02;  ///< [m^2] visible of a part of the clothes whose color is seen
  double shade = 0.90;          ///< light on clothes, over that on a surface that faces the camera
  double lightness = 1.5;       ///< standard deviation of the color's lightness, beside the light's
  double chromaticity = 0.8;    ///< and of its a and b
};

/// Somebody as the detector sees them, from the camera's place on the floor.
struct ModelledSighting {
  double forward = 0.0, left = 0.0;  ///< [m]
  double height = 0.0;               ///< [m] of the highest visible point; 0: it leaves the image
  imaging::Appearance appearance{};  ///< the colors of the clothes
  bool head_hidden = false;          ///< something nearer may hide a head over the highest point
};

class PeopleModel {
 public:
  PeopleModel(const PeopleModelConfig& config, std::uint64_t seed);

  /// Whom the detector would find in an image of this camera now. Up to 100 us with people before
  /// the camera, next to nothing without; no allocation after the first calls. `colors`: there is a
  /// color image of this moment, too.
  void find(const World& world, const DepthCamera& camera, bool colors,
            std::vector<ModelledSighting>& sightings);

 private:
  /// What can be seen of somebody.
  struct Visible {
    double area = 0.0;               ///< [m^2]
    double top = 0.0;                ///< [m]
    double upper = 0.0, legs = 0.0;  ///< [m^2] of the clothes of trunk and legs
  };
  bool may_be_seen(const Person& person, const Pose2& origin) const;
  void look(const World& world, const DepthCamera& camera, const Pose2& origin);
  bool in_view(double forward, double height) const;
  imaging::ClothesColor color_of(const rendering::Clothes::Color& clothes, double visible,
                                 const rendering::Gains& gains);

  PeopleModelConfig config_;
  Random random_, color_random_;
  Fan fan_;
  RayCaster caster_;
  FanHits hits_;
  std::vector<std::uint8_t> see_through_;  // glass, for each beam
  std::vector<Mover> movers_;
  std::vector<Visible> visible_;
  double camera_height_ = 0.0, down_ = 0.0;
  double ahead_ = 0.0;  ///< [m] the camera, of the axle, where it looks
};

}  // namespace usher::world
