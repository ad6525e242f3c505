#pragma once

#include <cstdint>
#include <vector>

#include "perception/face_detector/core/face_detector.hpp"
#include "simulation/rendering/core/depth_sensor.hpp"
#include "simulation/rendering/core/painter.hpp"

namespace usher::face_study {

/// A room of 7 x 6 m as the Pioneer's Kinect sees it: cabinets, and things on walls and fronts that
/// cascades take for faces of a size that no face has there.
class Stage {
 public:
  /// `features` of those things, at most 11. People wear `faces` in turn; none: drawn ones.
  static Result<Stage> make(std::size_t features, std::uint64_t seed,
                            std::vector<rendering::Texture> faces = {});

  struct Shot {
    std::vector<std::uint8_t> rgb;
    std::vector<std::uint16_t> millimeters;
    int width = 0, height = 0;
    imaging::ColorImage color() const { return {width, height, rgb}; }
    imaging::DepthImage depth() const { return {width, height, millimeters}; }
  };
  const Shot& shoot(const std::vector<rendering::Body>& bodies);

  /// Where the middle of something [m] in the room is in the image [pixels]; a box of no size.
  face_detector::Box pixel_of(const Eigen::Vector3d& point) const;
  /// Where the middles of the things are.
  const std::vector<Eigen::Vector3d>& features() const { return features_; }

 private:
  Stage(rendering::Renderer renderer, std::uint64_t seed, std::vector<rendering::Texture> faces);
  rendering::Renderer renderer_;
  rendering::DepthSensor sensor_;
  rendering::Painter painter_;
  geometry::Pose3 room_T_camera_;
  std::vector<Eigen::Vector3d> features_;
  Shot shot_;
};

/// Somebody who looks at the camera, `ahead` of it and `left` [m].
rendering::Body standing(double ahead, double left, double height);

}  // namespace usher::face_study
