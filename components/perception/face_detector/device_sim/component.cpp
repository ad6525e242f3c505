#include "perception/face_detector/device_sim/component.hpp"

namespace usher::face_detector {

namespace {
using runtime::HealthState;
constexpr auto kImageAge = std::chrono::milliseconds(500);  // as the real one
}  // namespace

FaceDetectorSimComponent::FaceDetectorSimComponent(runtime::Host& host) : host_(host) {
  faces_ = host.output(topics::kFaces);
  seen_ = host.input(
      topics::kSimKinectFaces,
      {.max_age = kImageAge, .on_loss = "publishes no faces, says that there are no images"},
      [this](const auto& message, const auto&) {
        host_.health().set(HealthState::kOk);
        faces_.publish(message);
      },
      [this] { host_.health().set(HealthState::kDegraded, "no image of the Kinect"); });
}

}  // namespace usher::face_detector
