#include "perception/people_detector/shell/component.hpp"

namespace usher::people_detector {

PeopleDetectorComponent::PeopleDetectorComponent(runtime::Host& host)
    : config_(read_detector(host.parameters())),
      following_(host, [this] { return trouble(); }),
      kinect_(host, following_,
              {"Kinect", Source::kKinect, &topics::kKinectProcessed, &topics::kKinectColor,
               &topics::kKinectInfo},
              config_),
      rear_(host, following_,
            {"rear camera", Source::kRearCamera, &topics::kRearProcessed, &topics::kRearColor,
             &topics::kRearInfo},
            config_) {}

std::string PeopleDetectorComponent::trouble() const {
  std::string kinect = kinect_.trouble();
  return kinect.empty() ? rear_.trouble() : kinect;
}

}  // namespace usher::people_detector
