#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "perception/people_detector/core/depth_detector.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"
#include "simulation/rendering/core/depth_sensor.hpp"

namespace usher::people_study {

/// What a camera over the origin of the floor, looking along x, has before it.
struct Scene {
  std::string name;
  rendering::Model model;
  std::vector<rendering::Body> bodies;
  depth_pipeline::CameraPose camera;  ///< forward is 0
};

/// A body as it can be seen.
struct Truth {
  double forward = 0.0, left = 0.0;  ///< [m] the hips
  double area = 0.0;                 ///< [m^2] that is visible
};
/// Of which more is visible must be found: two fifths of somebody who stands; who is less visible
/// may be found.
inline constexpr double kVisible = 0.2;  // [m^2]

/// How hard a random scene is: as rooms are, or to learn from, with more things and with more
/// people who sit, squat or bend.
enum class Crowd { kUsual, kHard };
/// A room with furniture, walls, poles, boards and other things that are upright, and up to five
/// people of any posture, some of them side by side; the same for the same seed.
Scene random_scene(std::uint64_t seed, Crowd crowd = Crowd::kUsual);
/// The same room seen by MARVIN's rear camera, where config/robots/marvin.yaml mounts it.
Scene rear_scene(std::uint64_t seed, Crowd crowd = Crowd::kUsual);
/// The cases of thesis figures 8.17 to 8.21, and beyond them people in a wheelchair, half hidden,
/// partly out of the image, at every distance and lean.
std::vector<Scene> thesis_scenes();

/// An image of a scene through the whole chain: camera, noise, depth pipeline.
class Studio {
 public:
  explicit Studio(const rendering::DepthSensorConfig& sensor = rendering::kinect_v2());
  struct Shot {
    imaging::DepthImage raw, processed;  ///< valid until the next
    people_detector::View view;
    std::vector<Truth> truths;  ///< of each body
  };
  /// The error says what of the scene cannot be.
  Result<Shot> take(const Scene& scene, std::uint64_t seed);
  const imaging::Intrinsics& intrinsics() const { return intrinsics_; }
  const rendering::Hits& hits() const { return hits_; }

 private:
  std::vector<Truth> truths_of(const Scene& scene) const;

  rendering::DepthSensorConfig sensor_;
  imaging::Intrinsics intrinsics_;
  depth_pipeline::DepthPipeline pipeline_;
  rendering::Hits hits_;
  std::vector<std::uint16_t> raw_, processed_;
};

}  // namespace usher::people_study
