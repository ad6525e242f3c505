#include "perception/people_detector/device_sim/component.hpp"

#include <cmath>

#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::people_detector {

namespace {
using std::chrono::milliseconds;
constexpr auto kImageAge = milliseconds(300);
constexpr auto kPeriod = milliseconds(50);  // as often as the real one looks at an image
}  // namespace

PeopleDetectorSimComponent::PeopleDetectorSimComponent(runtime::Host& host)
    : host_(host),
      rejected_(host.health().counter("images: rejected")),
      following_(host, [this] { return trouble(); }) {
  kinect_.name = "Kinect";
  rear_.name = "rear camera";
  rear_.source = Source::kRearCamera;
  read(kinect_, topics::kSimKinectPeople);
  read(rear_, topics::kSimRearPeople);
}

void PeopleDetectorSimComponent::read(Camera& camera, const topics::Topic<Sightings>& topic) {
  camera.input = host_.input(
      topic, {.max_age = kImageAge, .on_loss = "goes on with the other sensors", .optional = true},
      [this, &camera](const auto& message, const auto&) { take(camera, message); },
      [this, &camera] {
        if (camera.heard) following_.report();
      });
}

void PeopleDetectorSimComponent::take(Camera& camera, const Sightings& message) {
  camera.heard = true;
  const runtime::Time stamp = wire::from_message(message.header().stamp());
  if (stamp >= camera.last && stamp - camera.last < kPeriod) return;
  camera.last = stamp;
  following_.transforms().when_known(frames::kOdom, message.header().frame_id(), stamp,
                                     [this, &camera, message, stamp](const auto& pose) {
                                       look(camera, message, stamp, geometry::to_plane(pose));
                                     });
}

void PeopleDetectorSimComponent::look(Camera& camera, const Sightings& message, runtime::Time stamp,
                                      const geometry::Pose2& odom_T_foot) {
  const auto odom_T_base =
      following_.transforms().lookup_planar(frames::kOdom, frames::kBaseFootprint, stamp);
  if (!odom_T_base) {
    ++rejected_;
    return;
  }
  found_.clear();
  for (const auto& one : message.sightings())
    found_.push_back({one.forward(), one.left(), one.height(), 0.0,
                      wire::from_message(one.appearance()), one.head_hidden()});
  following_.see(camera.source, stamp, found_, *odom_T_base, inverse(*odom_T_base) * odom_T_foot);
}

std::string PeopleDetectorSimComponent::trouble() const {
  for (const Camera* camera : {&kinect_, &rear_}) {
    if (camera->heard && camera->input.fresh() == nullptr)
      return std::string("no image of the ") + camera->name;
  }
  return {};
}

}  // namespace usher::people_detector
