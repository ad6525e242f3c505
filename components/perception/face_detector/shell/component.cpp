#include "perception/face_detector/shell/component.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/images.hpp"
#include "wire/tilt_servo.hpp"

namespace usher::face_detector {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kImageAge = milliseconds(500);
constexpr auto kApart = milliseconds(17);   // color and depth of one pair, at 30 Hz
constexpr auto kSearch = milliseconds(20);  // of a pair, for simulation
constexpr double kFar8Bit = 12.0;           // [m] of an 8-bit depth image
constexpr const char* kNoFaces = "publishes no faces, says which image is missing";

SizeModel read_model(runtime::Parameters& p, const std::string& name, const std::string& where) {
  const SizeModel usual;
  const auto values = p.numbers(
      name, "-", {-1000, 10000}, 5, 5, {usual.a, usual.b, usual.c, usual.least, usual.most},
      "Faces " + where +
          ": a, b, c of 1 / depth = a + b size + c size^2 in metres and pixels, "
          "then the least and the largest size; from `usher calibrate faces`.");
  if (values.size() != 5) return usual;
  return {values[0], values[1], values[2], values[3], values[4]};
}

FaceDetectorConfig read_config(runtime::Parameters& p) {
  FaceDetectorConfig c;
  c.model.center = read_model(p, "center_model", "in the middle of the image");
  c.model.side = read_model(p, "side_model", "at the sides of the image");
  c.model.middle = p.number("middle", "-", {0, 1}, c.model.middle,
                            "Share of the image's width that the center model is for.");
  c.rules.near = p.number("near", "m", {0.1, 2}, c.rules.near, "Nearer faces are not looked for.");
  c.rules.far = p.number("far", "m", {0.5, 8}, c.rules.far, "Farther faces are refused.");
  c.rules.tolerance =
      p.number("tolerance", "-", {0.01, 0.9}, c.rules.tolerance,
               "So far may the depth be from what the size lets expect, as a share of that.");
  c.rules.measured = p.number("measured", "-", {0, 1}, c.rules.measured,
                              "Share of a face's middle that must have a depth.");
  c.rules.whole = p.number("whole", "-", {0, 1}, c.rules.whole,
                           "Share of a face's middle half that lies at its depth.");
  c.rules.relief =
      p.number("relief", "m", {0, 0.5}, c.rules.relief,
               "By which a head stands before what is left and right of it, both added; 0 = any.");
  c.step = p.number("step", "-", {1.05, 1.5}, c.step, "Between the sizes that are looked for.");
  c.neighbors = static_cast<int>(
      p.integer("neighbors", "-", {1, 50}, c.neighbors, "Windows that must agree on a face."));
  return c;
}

/// Of the camera on its mount when no servo turns it.
geometry::Pose3 read_mount(runtime::Parameters& p) {
  const double x =
      p.number("robot.kinect.mount_x", "m", {-1, 1}, "Kinect ahead of the axle's middle.");
  const double z = p.number("robot.kinect.mount_z", "m", {0, 3}, "Kinect above the axle's middle.");
  const double axle = p.number("robot.wheel_radius", "m", {0.05, 0.5},
                               "Of the driven wheels; also the axle's height.");
  return fixed_camera(x, z + axle, wire::read_tilt_servo(p).angle_of(0.0));
}

}  // namespace

void FaceDetectorComponent::Job::run() {
  error.clear();
  faces.clear();
  if (!detector) {
    auto made = FaceDetector::make(cascade, config);
    if (!made) {
      error = made.error();
      hopeless = true;
      return;
    }
    detector.emplace(std::move(made).value());
  }
  const auto color = wire::color_image(*pair.color, rgb);
  const auto depth = wire::depth_image(*pair.depth, kFar8Bit, millimeters);
  if (!color || !depth) {
    error = color ? depth.error() : color.error();
    return;
  }
  const auto found = detector->find(*color, *depth);
  if (!found) {
    error = found.error();
    return;
  }
  width = color->width, height = color->height;
  faces.assign(found->begin(), found->end());
}

FaceDetectorComponent::FaceDetectorComponent(runtime::Host& host)
    : host_(host),
      rejected_(host.health().counter("pairs: rejected")),
      replaced_(host.health().counter("pairs: replaced by newer ones")),
      transforms_(host) {
  auto& p = host.parameters();
  const std::string name = p.choice("cascade", cascade_names(), "alt", "Which cascade of OpenCV.");
  job_->cascade = cascade_file(
      name, p.file("cascades", "", "Folder with haarcascades and lbpcascades; none: Debian's."));
  job_->config = read_config(p);
  const double rate = p.number("rate", "Hz", {1, 30}, 10.0, "At most so many pairs a second.");
  period_ = std::chrono::duration_cast<runtime::Duration>(
      std::chrono::duration<double>(0.9 / rate));  // pairs come at 30 Hz, not quite evenly
  const geometry::Pose3 mount = read_mount(p);
  if (p.choice("mount", {"fixed", "tf"}, "fixed",
               "The camera stands still on the robot, or tf tells where it is.") == "fixed") {
    fixed_ = mount;
  }
  for (const SizeModel* model : {&job_->config.model.center, &job_->config.model.side}) {
    if (const auto status = check(*model); !status) host.fault(status.error());
  }

  info_ = host.input(topics::kKinectInfo, {},
                     [this](const auto& info, const auto&) { take_info(info); });
  const auto missing = [this](const char* what) {
    return [this, what] { host_.health().set(HealthState::kDegraded, what); };
  };
  color_ = host.input(
      topics::kKinectColor, {.max_age = kImageAge, .on_loss = kNoFaces},
      [this](const auto&, const auto&) { take_images(); }, missing("no color image"));
  depth_ = host.input(
      topics::kKinectDepth, {.max_age = kImageAge, .on_loss = kNoFaces},
      [this](const auto&, const auto&) { take_images(); }, missing("no depth image"));
  faces_ = host.output(topics::kFaces);
}

void FaceDetectorComponent::take_info(const sensor_msgs::msg::CameraInfo& info) {
  const auto intrinsics = wire::from_message(info);
  if (!intrinsics) {
    ++rejected_;
    host_.health().set(HealthState::kDegraded, "camera_info: " + intrinsics.error());
    return;
  }
  intrinsics_ = *intrinsics;
}

/// Color and depth come one by one; whichever is the second makes the pair.
void FaceDetectorComponent::take_images() {
  if (color_.latest() == nullptr || depth_.latest() == nullptr) return;
  Pair pair{color_.share(), depth_.share(), {}};
  const auto color = wire::from_message(pair.color->header().stamp());
  const auto depth = wire::from_message(pair.depth->header().stamp());
  if (color - depth > kApart || depth - color > kApart) return;
  pair.stamp = depth;
  if (pair.stamp >= last_ && pair.stamp - last_ < period_) return;
  last_ = pair.stamp;
  if (busy_) {
    replaced_ += waiting_.has_value();
    waiting_ = std::move(pair);
    return;
  }
  start(std::move(pair));
}

void FaceDetectorComponent::start(Pair pair) {
  busy_ = true;
  job_->pair = std::move(pair);
  host_.offload(
      kSearch, [job = job_] { job->run(); }, [this] { finish(); });
}

void FaceDetectorComponent::finish() {
  busy_ = false;
  if (job_->hopeless) host_.fault(job_->error);
  const runtime::Time stamp = job_->pair.stamp;
  const std::string frame = job_->pair.depth->header().frame_id();
  if (!job_->error.empty() || !intrinsics_) {
    ++rejected_;
    host_.health().set(HealthState::kDegraded, intrinsics_ ? job_->error : "no camera_info");
  } else if (fixed_) {
    publish(stamp, *fixed_);
  } else {
    // The search took longer than the transform needs to come.
    const auto camera = transforms_.lookup(frames::kBaseFootprint, frame, stamp);
    if (camera) {
      publish(stamp, *camera);
    } else {
      ++rejected_;
      host_.health().set(HealthState::kDegraded, "nobody knows where " + frame + " is");
    }
  }
  if (!waiting_) return;
  Pair next = std::move(*waiting_);
  waiting_.reset();
  start(std::move(next));
}

void FaceDetectorComponent::publish(runtime::Time stamp, const geometry::Pose3& base_T_camera) {
  host_.health().set(HealthState::kOk);
  message_.header(wire::header(stamp, frames::kBaseFootprint));
  message_.image_width(static_cast<std::uint32_t>(job_->width));
  message_.image_height(static_cast<std::uint32_t>(job_->height));
  message_.faces().clear();
  for (const Face& face : job_->faces) {
    const Place place = place_of(face.box, face.depth, *intrinsics_, base_T_camera);
    usher_msgs::msg::Face told;
    told.left(static_cast<float>(face.box.left));
    told.top(static_cast<float>(face.box.top));
    told.width(static_cast<float>(face.box.width));
    told.height(static_cast<float>(face.box.height));
    told.depth(static_cast<float>(face.depth));
    told.range(static_cast<float>(place.range));
    told.bearing(static_cast<float>(place.bearing));
    told.elevation(static_cast<float>(place.elevation));
    told.neighbors(static_cast<std::uint16_t>(face.neighbors));
    message_.faces().push_back(told);
  }
  faces_.publish(message_);
}

}  // namespace usher::face_detector
