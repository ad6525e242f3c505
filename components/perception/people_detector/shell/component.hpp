#pragma once

#include "perception/people_detector/shell/camera_input.hpp"
#include "perception/people_detector/shell/following.hpp"

namespace usher::people_detector {

/// Knows who is around the robot: people in the images of the depth cameras and legs in the laser's
/// scan, followed over time. Event-driven.
class PeopleDetectorComponent final : public runtime::Component {
 public:
  explicit PeopleDetectorComponent(runtime::Host& host);

 private:
  std::string trouble() const;

  DetectorConfig config_;
  Following following_;
  CameraInput kinect_, rear_;
};

}  // namespace usher::people_detector
