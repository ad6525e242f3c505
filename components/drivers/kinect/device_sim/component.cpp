#include "drivers/kinect/device_sim/component.hpp"

namespace usher::kinect {

namespace {
using runtime::HealthState;
constexpr auto kSilence = std::chrono::milliseconds(300);

template <class Pass, class Message>
void pass(runtime::Host& host, Pass& way, const topics::Topic<Message>& from,
          const topics::Topic<Message>& to) {
  way.output = host.output(to);
  way.input = host.input(from, {.optional = true},
                         [&way](const auto& message, const auto&) { way.output.publish(message); });
}
}  // namespace

KinectSimComponent::KinectSimComponent(runtime::Host& host) : host_(host) {
  depth_.output = host.output(topics::kKinectDepth);
  depth_.input = host.input(
      topics::kSimKinectDepth, {.max_age = kSilence, .on_loss = "publishes nothing and says so"},
      [this](const auto& image, const auto&) {
        depth_.output.publish(image);
        host_.health().set(HealthState::kOk);
      },
      [this] { host_.health().set(HealthState::kDegraded, "the camera is silent"); });
  pass(host, color_, topics::kSimKinectColor, topics::kKinectColor);
  pass(host, info_, topics::kSimKinectInfo, topics::kKinectInfo);
  pass(host, rear_depth_, topics::kSimRearDepth, topics::kRearDepth);
  pass(host, rear_color_, topics::kSimRearColor, topics::kRearColor);
  pass(host, rear_info_, topics::kSimRearInfo, topics::kRearInfo);
}

}  // namespace usher::kinect
