#include "simulation/world/shell/depth_output.hpp"

#include "simulation/rendering/core/face_pictures.hpp"
#include "wire/appearance.hpp"
#include "wire/conversions.hpp"
#include "wire/images.hpp"
#include "wire/low_scan.hpp"
#include "wire/tilt_servo.hpp"

namespace usher::world {

namespace {

/// Half a period of 30 Hz: the cameras take turns.
constexpr auto kTurn = std::chrono::nanoseconds(16'666'667);
constexpr auto kRendering = std::chrono::milliseconds(10);  ///< of one image, with colors
constexpr int kColorsEvery = 6;  ///< 5 Hz of the modelled colors of clothes
constexpr int kRearEvery = 2;    ///< the rear camera has 15 Hz: the detector looks no more often
constexpr const char* kKinectFrame = "kinect_depth_optical";
constexpr const char* kRearFrame = "rear_camera_depth_optical";

template <class Config>
Config model_for(const DepthCameraConfig& camera) {
  Config config;
  config.lens = camera.sensor.lens;
  config.origin = std::abs(camera.mount.x);
  return config;
}

std::vector<rendering::Texture> drawn_faces() {
  constexpr std::uint64_t kFaces = 16;
  std::vector<rendering::Texture> faces;
  for (std::uint64_t number = 0; number < kFaces; ++number)
    faces.push_back(rendering::drawn_face(number));
  return faces;
}

}  // namespace

DepthCameraConfig DepthOutput::read_kinect(runtime::Parameters& p) {
  DepthCameraConfig config;
  const std::string kind = p.choice("robot.kinect.model", {"v2", "v1"}, "v2",
                                    "Kinect v2 (512 x 424) or v1 (640 x 480).");
  config.sensor = kind == "v1" ? rendering::kinect_v1() : rendering::kinect_v2();
  config.mount.x =
      p.number("robot.kinect.mount_x", "m", {-1, 1}, 0.2, "Kinect ahead of the axle's middle.");
  config.mount.z =
      p.number("robot.kinect.mount_z", "m", {0, 3}, 0.665, "Kinect above the axle's middle.") +
      p.number("kinect_height_error", "m", {-0.1, 0.1}, 0.0,
               "How much higher the Kinect really sits than the robot's file says.");
  const auto servo = wire::read_tilt_servo(p);
  config.servo_gain = 1.0 / servo.gain;
  config.servo_offset =
      servo.angle_of(0.0) + p.number("kinect_angle_error", "rad", {-0.1, 0.1}, 0.0,
                                     "How much higher the Kinect really looks.");
  return config;
}

DepthCameraConfig DepthOutput::read_rear(runtime::Parameters& p) {
  DepthCameraConfig config;
  config.sensor = rendering::rear_camera();
  config.mount.x = p.number("robot.rear_camera.mount_x", "m", {-1, 1}, -0.2,
                            "Rear camera ahead of the axle's middle; negative is behind.");
  config.mount.z = p.number("robot.rear_camera.mount_z", "m", {0, 3}, 0.9,
                            "Rear camera above the axle's middle.");
  config.mount.yaw = geometry::kPi;
  config.mount.pitch = -p.number("robot.rear_camera.angle", "rad", {-0.6, 0.6}, -0.26,
                                 "Of the rear camera on the body, positive up.");
  return config;
}

DepthOutput::DepthOutput(runtime::Host& host, const World* world, std::uint64_t seed)
    : host_(host),
      world_(world),
      kinect_(read_kinect(host.parameters()), seed),
      rear_(read_rear(host.parameters()), seed + 1),
      kinect_pixels_{.camera = kinect_, .frame = kKinectFrame},
      rear_pixels_{.camera = rear_, .frame = kRearFrame},
      late_images_(host.health().counter("images: late")) {
  const std::string kind = host.parameters().choice(
      "depth", {"off", "model", "pixels"}, "off",
      "Depth cameras: rendered pixels, or the scans of the model that is fitted to them.");
  if (kind == "model") kind_ = Kind::kModel;
  if (kind == "pixels") kind_ = Kind::kPixels;
  read_faces();
  every_ = static_cast<int>(host.parameters().integer(
      "images_every", "-", {1, 30}, 1, "Only every n-th image of the 30 a second is rendered."));
  has_rear_ = host.parameters().flag("robot.rear_camera.fitted", true,
                                     "Whether the robot has a rear camera.");
  const bool fitted = host.parameters().flag(
      "depth_refit", false,
      "The modelled depth pipeline fits the floor in every frame, as its own refit.");
  const double low_from = wire::read_kinect_blind_range(host.parameters());
  for (auto* models : {&kinect_model_, &rear_model_}) {
    const bool rear = models == &rear_model_;
    auto config = model_for<DepthScanModelConfig>((rear ? rear_ : kinect_).config());
    config.low_from = low_from;
    models->emplace(fitted ? with_fitted_floor(config) : config, rear ? seed + 1 : seed);
  }
  kinect_people_model_.emplace(model_for<PeopleModelConfig>(kinect_.config()), seed);
  rear_people_model_.emplace(model_for<PeopleModelConfig>(rear_.config()), seed + 1);
  FaceModelConfig faces;
  faces.lens = kinect_.config().sensor.lens;
  faces.missed = host.parameters().number("faces_missed", "-", {0, 1}, faces.missed,
                                          "Share of images in which a face is missed (model).");
  faces.false_alarms = host.parameters().number("faces_false", "-", {0, 1}, faces.false_alarms,
                                                "Faces per image that are none (model).");
  face_model_.emplace(faces, seed);
  faces_ = host.output(topics::kSimKinectFaces);
  kinect_pixels_.depths = host.output(topics::kSimKinectDepth);
  kinect_pixels_.colors = host.output(topics::kSimKinectColor);
  kinect_info_ = host.output(topics::kSimKinectInfo);
  rear_pixels_.depths = host.output(topics::kSimRearDepth);
  rear_pixels_.colors = host.output(topics::kSimRearColor);
  rear_info_ = host.output(topics::kSimRearInfo);
  kinect_scan_ = host.output(topics::kSimKinectScan);
  kinect_low_ = host.output(topics::kSimKinectScanLow);
  rear_scan_ = host.output(topics::kSimRearScan);
  kinect_people_ = host.output(topics::kSimKinectPeople);
  rear_people_ = host.output(topics::kSimRearPeople);
  timer_ = host.timer("depth", kTurn, [this](auto) { publish_next(); });
}

void DepthOutput::read_faces() {
  const bool color =
      host_.parameters().flag("color", false, "Whether colour images are painted too.");
  colors_every_ = static_cast<int>(host_.parameters().integer(
      "colors_every", "-", {1, 30}, 1, "Of them only every n-th of the 30 a second."));
  const std::string folder = host_.parameters().file(
      "face_pictures", "",
      "Folder of pictures, one face each, that the people have in turn; empty: drawn faces.");
  if (!color) return;
  if (folder.empty()) {
    painter_.emplace(drawn_faces());
    return;
  }
  auto faces = rendering::load_faces(folder);
  if (!faces) host_.fault("face_pictures: " + faces.error());
  painter_.emplace(std::move(faces).value());
}

void DepthOutput::step(runtime::Time now) {
  kinect_.step(world_->base().truth());
  rear_.step(world_->base().truth());
  stepped_ = now;
}

void DepthOutput::publish_next() {
  if (kind_ == Kind::kOff || world_ == nullptr || stepped_ == runtime::Time{}) return;
  if (!told_ && kind_ == Kind::kPixels) publish_info();
  told_ = true;
  deliver(kinect_next_ ? kinect_pixels_ : rear_pixels_);
  const bool rendered = kind_ != Kind::kPixels || images_ / 2 % every_ == 0;
  if (rendered && kinect_next_) publish_kinect();
  if (rendered && !kinect_next_ && has_rear_ && images_ / 2 % kRearEvery == 0) publish_rear();
  kinect_next_ = !kinect_next_;
  ++images_;
}

void DepthOutput::publish_info() {
  kinect_info_.publish(wire::to_message(stepped_, kKinectFrame,
                                        rendering::intrinsics_of(kinect_.config().sensor.lens)));
  if (!has_rear_) return;
  rear_info_.publish(
      wire::to_message(stepped_, kRearFrame, rendering::intrinsics_of(rear_.config().sensor.lens)));
}

void DepthOutput::publish_kinect() {
  if (kind_ == Kind::kModel) {
    kinect_model_->scan(*world_, kinect_, result_);
    publish_scan(result_.ranges, "kinect_level", kinect_scan_);
    publish_scan(result_.low, "kinect_level", kinect_low_);
    publish_people(*kinect_people_model_, kinect_, "kinect_level", kinect_people_);
    publish_faces();
    return;
  }
  take(kinect_pixels_);
}

void DepthOutput::take(Pixels& pixels) {
  Shot& shot = pixels.shots[1 - pixels.newest];
  if (shot.state != Shot::State::kNone) {
    ++late_images_;
    return;
  }
  pixels.newest = 1 - pixels.newest;
  shot.state = Shot::State::kInWork;
  shot.due = false;
  shot.stamp = stepped_;
  shot.exposure = pixels.camera.exposure(*world_);
  renderer_.look(*world_, shot.moment);
  shot.painted = painter_ && images_ / 2 % colors_every_ == 0;
  if (shot.painted) {
    shot.gains.clear();
    for (const Person& person : world_->people())
      shot.gains.push_back(pixels.camera.gains(*world_, person.position));
  }
  host_.offload(
      kRendering, [this, &pixels, &shot] { render(pixels, shot); },
      [this, &pixels, &shot] {
        if (!shot.error.empty()) host_.fault(shot.error);
        shot.state = Shot::State::kReady;
        // Before the depths of the same moment: whoever has those has the colors, too. Not with
        // them: a color image is the larger one, and they would come later for it.
        if (shot.painted) pixels.colors.publish(shot.color);
        if (shot.due) publish(pixels, shot);
      });
}

/// Beside the handlers.
void DepthOutput::render(Pixels& pixels, Shot& shot) {
  if (const auto status = renderer_.show(shot.moment); !status) {
    shot.error = status.error();
    return;
  }
  pixels.camera.measure(shot.exposure, renderer_.renderer(), depth_);
  const rendering::Lens& lens = pixels.camera.config().sensor.lens;
  if (shot.painted) {
    painter_->paint(pixels.camera.truth(), lens, shot.exposure.world_T_camera, shot.moment.bodies,
                    shot.gains, rgb_);
    wire::to_color_message(shot.stamp, pixels.frame, lens.width, rgb_, shot.color);
  }
  wire::to_message(shot.stamp, pixels.frame, imaging::DepthImage{lens.width, lens.height, depth_},
                   shot.depth);
}

/// What was taken two turns ago.
void DepthOutput::deliver(Pixels& pixels) {
  Shot& shot = pixels.shots[pixels.newest];
  shot.due = true;
  if (shot.state == Shot::State::kReady) publish(pixels, shot);
}

void DepthOutput::publish(Pixels& pixels, Shot& shot) {
  pixels.depths.publish(shot.depth);
  shot.state = Shot::State::kNone;
}

void DepthOutput::publish_rear() {
  if (kind_ == Kind::kModel) {
    rear_model_->scan(*world_, rear_, result_);
    publish_scan(result_.ranges, "rear_camera_level", rear_scan_);
    publish_people(*rear_people_model_, rear_, "rear_camera_level", rear_people_);
    return;
  }
  take(rear_pixels_);
}

void DepthOutput::publish_scan(const std::vector<float>& ranges, const char* frame,
                               runtime::Output<sensor_msgs::msg::LaserScan>& output) {
  scan_.header(wire::header(stepped_, frame));
  scan_.angle_min(static_cast<float>(result_.angle_min));
  scan_.angle_increment(static_cast<float>(result_.increment));
  scan_.angle_max(static_cast<float>(
      result_.angle_min + result_.increment * (static_cast<double>(ranges.size()) - 1.0)));
  scan_.range_min(0.05F);
  scan_.range_max(5.0F);
  scan_.ranges(ranges);
  output.publish(scan_);
}

/// The face detector looks at every third image.
void DepthOutput::publish_faces() {
  if (images_ / 2 % 3 != 0) return;
  face_model_->find(*world_, kinect_, seen_faces_);
  faces_message_.header(wire::header(stepped_, "base_footprint"));
  faces_message_.image_width(static_cast<std::uint32_t>(kinect_.config().sensor.lens.width));
  faces_message_.image_height(static_cast<std::uint32_t>(kinect_.config().sensor.lens.height));
  faces_message_.faces().clear();
  for (const ModelledFace& face : seen_faces_) {
    auto& told = faces_message_.faces().emplace_back();
    told.left(static_cast<float>(face.left));
    told.top(static_cast<float>(face.top));
    told.width(static_cast<float>(face.side));
    told.height(static_cast<float>(face.side));
    told.depth(static_cast<float>(face.depth));
    told.range(static_cast<float>(face.range));
    told.bearing(static_cast<float>(face.bearing));
    told.elevation(static_cast<float>(face.elevation));
    told.neighbors(3);
  }
  faces_.publish(faces_message_);
}

/// The detector looks at every second image.
void DepthOutput::publish_people(PeopleModel& model, const DepthCamera& camera, const char* frame,
                                 runtime::Output<usher_sim_msgs::msg::Sightings>& output) {
  if (images_ / 2 % 2 != 0) return;
  model.find(*world_, camera, images_ / 2 % kColorsEvery == 0, found_);
  people_.header(wire::header(stepped_, frame));
  people_.sightings().resize(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i) {
    auto& sighting = people_.sightings()[i];
    sighting.forward(found_[i].forward);
    sighting.left(found_[i].left);
    sighting.height(found_[i].height);
    sighting.appearance(wire::to_message(found_[i].appearance));
    sighting.head_hidden(found_[i].head_hidden);
  }
  output.publish(people_);
}

}  // namespace usher::world
