#include "sensing/depth_pipeline/shell/component.hpp"

#include <cmath>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/images.hpp"

namespace usher::depth_pipeline {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kImageAge = milliseconds(300);
constexpr auto kTiltAge = milliseconds(500);
constexpr auto kFuture = milliseconds(20);
constexpr auto kAnswer = milliseconds(200);  // an order's way to the servo, and two readings
constexpr auto kPitchGap = milliseconds(100);
constexpr auto kTurn = milliseconds(2000);  // no turn of the servo takes longer
constexpr double kElsewhere = 0.05;         // [rad] the camera is off where it shall look
constexpr const char* kNoScans = "publishes no scans: the costmap keeps what it knows, degraded";

/// base_footprint_T_camera of the optical frame (x right, y down, z forward).
geometry::Pose3 optical(const CameraPose& pose, bool backward) {
  const double yaw = backward ? geometry::kPi : 0.0;
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return {{backward ? -pose.forward : pose.forward, 0.0, pose.height},
          geometry::from_roll_pitch_yaw(0.0, 0.0, yaw) *
              geometry::from_roll_pitch_yaw(pose.roll, pose.down, 0.0) * Eigen::Quaterniond(axes)};
}

}  // namespace

DepthPipelineComponent::DepthPipelineComponent(runtime::Host& host)
    : host_(host),
      config_(read_pipeline(host.parameters())),
      without_kinect_(read_without_kinect(host.parameters())),
      tilt_(host),
      pitch_(
          host, kNoScans, [this] { process_waiting(); }, without_kinect_),
      refused_tilts_(host.health().counter("kinect/tilt: refused")),
      rejected_(host.health().counter("images: rejected")),
      without_pitch_(host.health().counter("images: without pitch")),
      without_tilt_(host.health().counter("images: without tilt")),
      while_turning_(host.health().counter("images: camera turning")),
      blind_(host.health().counter("images: blind")),
      frozen_(host.health().counter("images: frozen")),
      refitted_(host.health().counter("images: floor fitted")),
      drops_(host.health().counter("images: with missing floor")) {
  auto& p = host.parameters();
  far_ = p.number("far_of_8_bit", "m", {1, 20}, far_, "What 255 means in an 8-bit image.");
  mount_slope_ = read_kinect_mount_slope(p);
  kinect_.name = "Kinect";
  kinect_.structured_light =
      p.choice("robot.kinect.model", {"v2", "v1"}, "v2",
               "Whose noise a fitted floor has: Kinect v2 (time of flight) or v1.") == "v1";
  kinect_.frame = "kinect_depth_optical";
  const double axle = read_axle(p);
  kinect_.mount = read_kinect_mount(p, axle);
  const RearMount rear = read_rear_mount(p, axle);
  rear_.name = "rear camera";
  rear_.structured_light = true;
  rear_.frame = "rear_camera_depth_optical";
  rear_.mount = rear.mount;
  rear_angle_ = rear.angle;
  rear_fitted_ = rear.fitted;

  const ScanOutput::Frame kinect_level{kKinectLevel, kinect_.mount.x, false};
  const ScanOutput::Frame rear_level{kRearLevel, -rear_.mount.x, true};
  kinect_.scan.emplace(host, topics::kKinectScan, kinect_level, config_.max_range);
  kinect_.low.emplace(host, topics::kKinectScanLow, kinect_level, config_.max_range);
  rear_.scan.emplace(host, topics::kRearScan, rear_level, config_.max_range);
  kinect_.output = host.output(topics::kKinectProcessed);
  rear_.output = host.output(topics::kRearProcessed);
  frames_ = host.output(topics::kTf);

  servo_reading_ = host.input(
      topics::kKinectTilt,
      {.max_age = kTiltAge,
       .on_loss = "trusts the last reading; leaves the Kinect's images out, degraded, when there "
                  "is none, or the camera was turning or is ordered to"},
      [this](const auto& tilt, const auto&) { take_tilt(tilt); });
  kinect_.info = host.input(topics::kKinectInfo, {},
                            [this](const auto& info, const auto&) { take_info(kinect_, info); });
  kinect_.images = host.input(
      topics::kKinectDepth, {.max_age = kImageAge, .on_loss = kNoScans},
      [this](const auto&, const auto&) { take_image(kinect_); },
      [this] {
        if (!kinect_.due) kinect_.due = host_.now();
        report();
      });
  rear_.info = host.input(topics::kRearInfo, {.optional = true},
                          [this](const auto& info, const auto&) { take_info(rear_, info); });
  rear_.images = host.input(
      topics::kRearDepth,
      {.max_age = kImageAge,
       .on_loss = "goes on with the Kinect alone; degraded when the robot has one",
       .optional = true},
      [this](const auto&, const auto&) { take_image(rear_); },
      [this] {
        if (rear_fitted_ && !rear_.due) rear_.due = host_.now();
        report();
      });
}

void DepthPipelineComponent::take_info(Camera& camera, const sensor_msgs::msg::CameraInfo& info) {
  const auto intrinsics = wire::from_message(info);
  if (!intrinsics) {
    refuse(camera, intrinsics.error());
    return;
  }
  if (camera.pipeline && camera.pipeline->intrinsics() == *intrinsics) return;
  PipelineConfig config = config_;
  if (camera.structured_light) config.refitted = for_structured_light(config.refitted);
  config.origin = camera.mount.backward ? -camera.mount.x : camera.mount.x;
  auto made = DepthPipeline::make(*intrinsics, config);
  if (!made) host_.fault(std::string(camera.name) + ": " + made.error());
  camera.pipeline.emplace(std::move(made).value());
}

void DepthPipelineComponent::process_waiting() {
  const bool back = host_.now() - pitch_came_ > kPitchGap;
  pitch_came_ = host_.now();
  for (Camera* camera : {&kinect_, &rear_}) {
    if (camera->waiting && process(*camera, *camera->waiting)) camera->waiting.reset();
  }
  if (back) report();
}

void DepthPipelineComponent::take_tilt(const usher_msgs::msg::CameraTilt& tilt) {
  const runtime::Time stamp = wire::from_message(tilt.header().stamp());
  // One from the future would make all later ones old.
  if (stamp - host_.now() > kFuture || !servo_.add(stamp.time_since_epoch(), tilt.servo()))
    ++refused_tilts_;
  if (!servo_.reaches(host_.now().time_since_epoch())) return;
  const kinematics::TiltServo& camera = tilt_.servo();
  if (std::abs(camera.angle_of(servo_.newest()) - camera.angle_of(tilt_.wanted())) <= kElsewhere) {
    elsewhere_.reset();
  } else if (!elsewhere_) {
    elsewhere_ = host_.now();
  }
}

/// Its servo is stuck or held: it sees people, low things and stairs elsewhere than where they
/// matter. Empty when it looks where it shall, or may still be on its way there.
std::string DepthPipelineComponent::looks_elsewhere() const {
  if (!elsewhere_ || host_.now() - *elsewhere_ <= kTurn) return {};
  const auto degrees = [&](double servo) {
    return std::to_string(std::lround(geometry::degrees(tilt_.servo().angle_of(servo)))) + " deg";
  };
  return "Kinect: looks " + degrees(servo_.newest()) + " up, not " + degrees(tilt_.wanted());
}

/// A turn that was ordered begins before any reading shows it: after the newest of them nobody
/// knows the tilt until they have had the time to.
bool DepthPipelineComponent::may_turn(runtime::Time stamp) const {
  const auto& order = tilt_.order();
  const runtime::Time read(servo_.newest_stamp());
  return order && stamp >= order->since && stamp > read && read < order->since + kAnswer &&
         std::abs(order->servo - servo_.newest()) > TiltHistory::kStill;
}

/// [rad] The camera's on the body at the time of an image; nothing, and the image is withheld,
/// where nobody knows it well enough. When the readings end in a turn it is not known where it came
/// to rest: no image is better than a whole floor of obstacles, which the costmap would keep.
std::optional<double> DepthPipelineComponent::angle_at(Camera& camera, runtime::Time stamp) {
  if (camera.mount.backward) return rear_angle_;
  if (!servo_.reaches(stamp.time_since_epoch())) {
    withhold(camera, without_tilt_, "no kinect/tilt says where it looks");
    return std::nullopt;
  }
  const auto servo = servo_.at(stamp.time_since_epoch());
  if (servo && !may_turn(stamp)) return tilt_.servo().angle_of(*servo);
  withhold(camera, while_turning_,
           servo_reading_.fresh() ? "it turns" : "kinect/tilt ended while it turned");
  return std::nullopt;
}

void DepthPipelineComponent::take_image(Camera& camera) {
  if (!camera.due) camera.due = host_.now();
  if (camera.waiting) {  // its pitch never came
    const auto pitch = pitch_.at(wire::from_message(camera.waiting->header().stamp()));
    withhold(camera, without_pitch_, "image without pitch: " + (pitch ? "" : pitch.error()));
  }
  camera.waiting.reset();
  auto image = camera.images.share();
  // Noise changes some pixel of every image; the first that differs ends the comparison.
  camera.repeated = camera.newest && camera.newest->data() == image->data();
  camera.newest = image;
  if (!process(camera, *image)) camera.waiting = std::move(image);
}

void DepthPipelineComponent::refuse(Camera& camera, const std::string& reason) {
  ++rejected_;
  camera.refused = reason;
  report();
}

void DepthPipelineComponent::withhold(Camera& camera, std::uint64_t& counter,
                                      const std::string& reason) {
  ++counter;
  camera.withheld = reason;
  report();
}

/// Why this camera gives no scans; empty when it does, and for one that the robot does not have.
std::string DepthPipelineComponent::trouble(const Camera& camera) const {
  if (!camera.due) return {};
  const std::string name = std::string(camera.name) + ": ";
  if (camera.images.fresh() == nullptr) return name + "no depth image";
  if (!camera.refused.empty()) return name + camera.refused;
  const bool turns =
      !camera.mount.backward && servo_reading_.fresh() && (servo_.turns() || may_turn(host_.now()));
  if (host_.now() - *camera.due <= (turns ? kTurn : kImageAge)) return {};
  return name + camera.withheld;
}

/// The one place that says how the component is, but for the pitch: that its input says.
void DepthPipelineComponent::report() {
  if (!pitch_.current()) return;
  if (std::string reason = trouble(kinect_); !reason.empty()) {
    host_.health().set(without_kinect_, std::move(reason));
    return;
  }
  std::string reason = trouble(rear_);
  if (reason.empty()) reason = looks_elsewhere();
  if (!reason.empty()) {
    host_.health().set(HealthState::kDegraded, std::move(reason));
  } else if (kinect_.delivered) {
    host_.health().set(HealthState::kOk);
  }
}

/// False while the pitch of the image's time is not known yet.
bool DepthPipelineComponent::process(Camera& camera, const Image& image) {
  const runtime::Time stamp = wire::from_message(image.header().stamp());
  const auto pitch = pitch_.at(stamp);
  if (!pitch) return false;
  const auto angle = angle_at(camera, stamp);
  if (!angle) return true;
  const auto depth = wire::depth_image(image, far_, camera.depth);
  if (!depth || !camera.pipeline) {
    refuse(camera, depth ? "no camera_info" : depth.error());
    return true;
  }
  Mount mount = camera.mount;
  if (!mount.backward) mount.z += mount_slope_ * *angle;
  if (std::chrono::abs(stamp - camera.rated) > kImageAge ||
      std::abs(*angle - camera.rated_at) > TiltHistory::kStill)
    camera.pipeline->forget_frames();
  camera.rated = stamp;
  camera.rated_at = *angle;
  const auto view = camera.pipeline->process(*depth, camera_pose(mount, *angle, pitch->angle));
  if (!view) {
    refuse(camera, view.error());
    return true;
  }
  camera.refused.clear();
  if (view->measured < config_.least_measured) {
    withhold(camera, blind_, "it measures nothing");
    return true;
  }
  if (camera.repeated && host_.now() - *camera.due > kImageAge) {
    withhold(camera, frozen_, "its image is frozen");
    return true;
  }
  publish(camera, *view, stamp);
  if (!camera.repeated) camera.due = host_.now();
  camera.delivered = true;
  report();
  return true;
}

void DepthPipelineComponent::publish(Camera& camera, const DepthView& view, runtime::Time stamp) {
  refitted_ += view.refitted;
  drops_ += view.drops > 0;
  tf2_msgs::msg::TFMessage place;
  place.transforms().push_back(wire::transform(stamp, frames::kBaseFootprint, camera.frame,
                                               optical(view.pose, camera.mount.backward)));
  place.transforms().push_back(camera.scan->place(stamp));
  frames_.publish(place);
  const ScanGeometry& geometry = camera.pipeline->geometry();
  camera.scan->publish(stamp, geometry.angle_min, geometry.increment, view.scan->ranges,
                       view.scan->intensities);
  if (camera.low) {
    camera.low->publish(stamp, geometry.angle_min, geometry.increment, view.low->ranges,
                        view.low->intensities, view.low_drops);
  }
  if (camera.output.reader_count() == 0) return;
  const imaging::Intrinsics& size = camera.pipeline->intrinsics();
  wire::to_message(stamp, camera.frame,
                   imaging::DepthImage{size.width, size.height, view.processed}, camera.processed);
  camera.output.publish(camera.processed);
}

}  // namespace usher::depth_pipeline
