#include "sensing/depth_pipeline/device_sim/component.hpp"

#include "wire/conversions.hpp"

namespace usher::depth_pipeline {

namespace {
using runtime::HealthState;
using std::chrono::milliseconds;
constexpr auto kScanAge = milliseconds(300);
}  // namespace

DepthPipelineSimComponent::DepthPipelineSimComponent(runtime::Host& host)
    : host_(host),
      config_(read_pipeline(host.parameters())),
      without_kinect_(read_without_kinect(host.parameters())),
      tilt_(host),
      rejected_(host.health().counter("scans: rejected")) {
  const double axle = read_axle(host.parameters());
  const Mount mount = read_kinect_mount(host.parameters(), axle);
  const RearMount rear = read_rear_mount(host.parameters(), axle);
  kinect_.least_confidence = rear_.least_confidence = config_.least_confidence;
  low_.least_confidence = config_.lasting_confidence;
  const ScanOutput::Frame kinect_level{kKinectLevel, mount.x, false};
  const ScanOutput::Frame rear_level{kRearLevel, -rear.mount.x, true};
  kinect_.output.emplace(host, topics::kKinectScan, kinect_level, config_.max_range);
  low_.output.emplace(host, topics::kKinectScanLow, kinect_level, config_.max_range);
  rear_.output.emplace(host, topics::kRearScan, rear_level, config_.max_range);
  frames_ = host.output(topics::kTf);
  kinect_.input = host.input(
      topics::kSimKinectScan, {.max_age = kScanAge, .on_loss = "publishes no scans, degraded"},
      [this](const auto& scan, const auto&) { take(kinect_, scan); }, [this] { report(); });
  low_.input =
      host.input(topics::kSimKinectScanLow,
                 {.max_age = kScanAge, .on_loss = "publishes no low scans", .optional = true},
                 [this](const auto& scan, const auto&) { take(low_, scan); });
  rear_.input = host.input(
      topics::kSimRearScan,
      {.max_age = kScanAge,
       .on_loss = "goes on with the Kinect alone; degraded when the robot has "
                  "one",
       .optional = true},
      [this](const auto& scan, const auto&) {
        rear_missing_ = false;
        take(rear_, scan);
      },
      [this, fitted = rear.fitted] {
        rear_missing_ = fitted || rear_.confidence;
        report();
      });
}

void DepthPipelineSimComponent::take(Channel& channel, const sensor_msgs::msg::LaserScan& scan) {
  if (!wire::check(scan)) {
    ++rejected_;
    return;
  }
  channel.ranges = scan.ranges();
  if (!channel.confidence || channel.bearings != channel.ranges.size()) {
    channel.bearings = channel.ranges.size();
    channel.intensities.resize(channel.bearings);
    channel.confidence.emplace(channel.bearings, config_.confidence_frames,
                               config_.confidence_threshold, config_.max_range);
  }
  const runtime::Time stamp = wire::from_message(scan.header().stamp());
  if (std::chrono::abs(stamp - channel.rated) > kScanAge) channel.confidence->forget();
  channel.rated = stamp;
  channel.confidence->rate(channel.ranges, channel.least_confidence, channel.intensities);
  if (&channel != &low_) {  // which is seen from where the Kinect's scan is
    tf2_msgs::msg::TFMessage place;
    place.transforms().push_back(channel.output->place(stamp));
    frames_.publish(place);
  }
  channel.output->publish(stamp, static_cast<double>(scan.angle_min()),
                          static_cast<double>(scan.angle_increment()), channel.ranges,
                          channel.intensities);
  if (kinect_.confidence) report();
}

void DepthPipelineSimComponent::report() {
  if (kinect_.input.fresh() == nullptr) {
    host_.health().set(without_kinect_, "no depth scan");
  } else if (rear_missing_) {
    host_.health().set(HealthState::kDegraded, "rear camera: no depth scan");
  } else {
    host_.health().set(HealthState::kOk);
  }
}

}  // namespace usher::depth_pipeline
