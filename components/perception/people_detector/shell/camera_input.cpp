#include "perception/people_detector/shell/camera_input.hpp"

#include <cmath>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/images.hpp"

namespace usher::people_detector {

namespace {

using std::chrono::milliseconds;

constexpr auto kImageAge = milliseconds(300);
// Every second image of a camera of 30 Hz, however unevenly they were taken.
constexpr auto kPeriod = milliseconds(50);
constexpr double kFar = 12.0;  // [m] that 255 means in an 8-bit image (thesis 4.9)

}  // namespace

DetectorConfig read_detector(runtime::Parameters& p) {
  DetectorConfig c;
  c.threshold = p.number("camera.threshold", "-", {-10, 10}, c.threshold,
                         "Log odds from which a window shows a person.");
  c.windows.farthest = p.number("camera.farthest", "m", {1, 8}, c.windows.farthest,
                                "Farther people are not looked for.");
  return c;
}

CameraInput::CameraInput(runtime::Host& host, Following& following, const Port& port,
                         const DetectorConfig& config)
    : host_(host),
      following_(following),
      port_(port),
      config_(config),
      rejected_(host.health().counter("images: rejected")),
      rejected_colors_(host.health().counter("color images: rejected")) {
  colors_ = host.input(*port.colors, {.optional = true});
  info_ = host.input(*port.info, {.optional = true},
                     [this](const auto& info, const auto&) { take_info(info); });
  images_ = host.input(
      *port.images,
      {.max_age = kImageAge, .on_loss = "goes on with the other sensors", .optional = true},
      [this](const auto&, const auto&) { take_image(images_.share()); },
      [this] {
        if (heard_) following_.report();
      });
}

void CameraInput::take_info(const sensor_msgs::msg::CameraInfo& info) {
  const auto intrinsics = wire::from_message(info);
  if (!intrinsics) {
    refuse(intrinsics.error());
    return;
  }
  if (detector_ && detector_->intrinsics() == *intrinsics) return;
  auto made = DepthDetector::make(*intrinsics, config_);
  if (!made) host_.fault(std::string(port_.name) + ": " + made.error());
  detector_.emplace(std::move(made).value());
  clothes_.emplace(*intrinsics);
}

void CameraInput::take_image(std::shared_ptr<const Image> image) {
  const runtime::Time stamp = wire::from_message(image->header().stamp());
  if (!heard_) looked_ = host_.now();
  heard_ = host_.now();
  if (stamp >= last_ && stamp - last_ < kPeriod) return;
  last_ = stamp;
  // The camera's place is written before its image: nearly always both are known by now.
  auto& transforms = following_.transforms();
  const std::string& frame = image->header().frame_id();
  const auto odom_T_base = transforms.lookup_planar(frames::kOdom, frames::kBaseFootprint, stamp);
  const auto base_T_optical = transforms.lookup(frames::kBaseFootprint, frame, stamp);
  if (odom_T_base && base_T_optical) {
    look(*image, stamp, *odom_T_base, *base_T_optical);
    return;
  }
  transforms.when_known(
      frames::kOdom, frame, stamp, [this, image = std::move(image), stamp](const auto& pose) {
        const auto base =
            following_.transforms().lookup(frames::kOdom, frames::kBaseFootprint, stamp);
        if (base) look(*image, stamp, geometry::to_plane(*base), inverse(*base) * pose);
      });
}

void CameraInput::look(const Image& image, runtime::Time stamp, const geometry::Pose2& odom_T_base,
                       const geometry::Pose3& base_T_optical) {
  looked_ = host_.now();
  if (!detector_) {
    refuse("no camera_info");
    return;
  }
  const auto depth = wire::depth_image(image, kFar, millimeters_);
  if (!depth) {
    refuse(depth.error());
    return;
  }
  const PlacedCamera camera = place_camera(base_T_optical);
  const auto sightings = detector_->find(*depth, camera.view);
  if (!sightings) {
    refuse(sightings.error());
    return;
  }
  refusal_.clear();
  seen_.assign(sightings->begin(), sightings->end());
  dress(*depth, camera.view, stamp);
  following_.see(port_.source, stamp, seen_, odom_T_base, camera.base_T_foot);
}

/// By the newest color image, if it is of the depth image's time.
void CameraInput::dress(const imaging::DepthImage& depth, const View& view, runtime::Time stamp) {
  const Image* message = colors_.latest();
  if (message == nullptr || seen_.empty()) return;
  const runtime::Time taken = wire::from_message(message->header().stamp());
  if (std::abs(runtime::seconds(taken - stamp)) > Clothes::kApart) return;
  const auto color = wire::color_image(*message, rgb_);
  if (!color || color->width != depth.width || color->height != depth.height) {
    ++rejected_colors_;
    return;
  }
  for (Sighting& one : seen_) one.appearance = clothes_->look(depth, *color, view, one);
}

void CameraInput::refuse(const std::string& reason) {
  ++rejected_;
  refusal_ = std::string(port_.name) + ": " + reason;
  following_.report();
}

std::string CameraInput::trouble() const {
  if (!refusal_.empty()) return refusal_;
  if (!heard_) return {};
  if (images_.fresh() == nullptr) return std::string("no image of the ") + port_.name;
  if (host_.now() - looked_ > kImageAge)
    return std::string("nobody says where the ") + port_.name + " is";
  return {};
}

}  // namespace usher::people_detector
