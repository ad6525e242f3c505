#include "sensing/scan_filter/shell/component.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::scan_filter {

namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

constexpr auto kScanAge = milliseconds(200);
constexpr double kLongestScan = 0.2;  // [s] from the first beam to the last

ScanFilterConfig laser_config(runtime::Parameters& p) {
  ScanFilterConfig c;
  c.mount_x = p.number("robot.laser.mount_x", "m", {-2, 2}, "Laser ahead of the axle's middle.");
  c.mount_z = p.number("robot.laser.mount_z", "m", {-1, 3}, "Laser above the axle's middle.");
  c.bearing_limit = p.number("robot.laser.self_filter", "rad", {0.1, 3.1},
                             "Beams beyond, to either side, see the robot itself.");
  c.axle_height = p.number("robot.wheel_radius", "m", {0.05, 0.5},
                           "Of the driven wheels; also the axle's height.");
  c.floor_margin = p.number("floor_margin", "m", {0, 0.5}, c.floor_margin,
                            "What is lower than this counts as floor.");
  c.max_height = p.number("max_height", "m", {0.5, 5}, c.max_height,
                          "What is higher is nothing to the robot.");
  c.least_echoes = static_cast<std::size_t>(
      p.integer("least_echoes", "-", {0, 500}, 20,
                "Beams of a laser scan that must meet something; with fewer the laser is blind and "
                "the robot stops."));
  return c;
}

ScanFilterConfig ultrasonic_config(runtime::Parameters& p, const ScanFilterConfig& laser) {
  ScanFilterConfig c = laser;
  c.mount_x = 0.0;  // the scan is seen from the middle of the ring
  c.mount_z = p.number("robot.ultrasonic.mount_z", "m", {-1, 3},
                       "Ring of the ultrasonic sensors above the axle's middle.");
  c.bearing_limit = 3.1;
  c.floor_margin = p.number("ultrasonic_floor_margin", "m", {0, 0.5}, 0.1,
                            "The same for the ultrasonic sensors with their wide beams.");
  c.least_echoes = 0;  // nothing within reach of five narrow beams is usual
  c.joined = false;
  return c;
}

}  // namespace

ScanFilterComponent::ScanFilterComponent(runtime::Host& host)
    : host_(host),
      pitch_(host, "publishes no scans: navigation stops", [this] { filter_waiting(); }),
      rejected_(host.health().counter("scans: rejected")),
      without_pitch_(host.health().counter("scans: without pitch")),
      floor_(host.health().counter("beams: floor")),
      high_(host.health().counter("beams: high")),
      mixed_(host.health().counter("beams: mixed")),
      invalid_(host.health().counter("beams: invalid")) {
  const ScanFilterConfig laser = laser_config(host.parameters());
  laser_ = make_channel("laser_level", laser, host.output(topics::kScanFiltered));
  ultrasonic_ = make_channel("ultrasonic_level", ultrasonic_config(host.parameters(), laser),
                             host.output(topics::kUltrasonicFiltered));
  frames_ = host.output(topics::kTfStatic);
  scan_ = host.input(
      topics::kScan, {.max_age = kScanAge, .on_loss = "publishes no scans: navigation stops"},
      [this](const auto&, const auto&) { take_scan(laser_, scan_.share()); },
      [this] { host_.health().set(HealthState::kDegraded, "no scan"); });
  sonar_ = host.input(
      topics::kUltrasonic,
      {.max_age = milliseconds(500), .on_loss = "publishes no ultrasonic scans", .optional = true},
      [this](const auto&, const auto&) { take_scan(ultrasonic_, sonar_.share()); });
}

ScanFilterComponent::Channel ScanFilterComponent::make_channel(
    const char* frame, const ScanFilterConfig& config,
    runtime::Output<sensor_msgs::msg::LaserScan> output) {
  auto filter = ScanFilter::make(config);
  if (!filter) host_.fault(std::string(frame) + ": " + filter.error());
  Channel channel;
  channel.frame = frame;
  channel.filter.emplace(std::move(filter).value());
  channel.output = output;
  return channel;
}

void ScanFilterComponent::filter_waiting() {
  for (Channel* channel : {&laser_, &ultrasonic_}) {
    if (channel->waiting && filter(*channel, *channel->waiting)) channel->waiting.reset();
  }
}

void ScanFilterComponent::take_scan(Channel& channel,
                                    std::shared_ptr<const sensor_msgs::msg::LaserScan> scan) {
  if (const Status status = wire::check(*scan); !status) return refuse(channel, status.error());
  if (channel.waiting) {  // its pitch never came
    ++without_pitch_;
    const auto pitch = pitch_.at(wire::from_message(channel.waiting->header().stamp()));
    if (&channel == &laser_ && !pitch && pitch_.current() && host_.now() - laser_left_ > kScanAge)
      host_.health().set(HealthState::kDegraded, "scan without pitch: " + pitch.error());
  }
  channel.waiting.reset();
  if (!filter(channel, *scan)) channel.waiting = std::move(scan);
}

void ScanFilterComponent::refuse(const Channel& channel, const std::string& reason) {
  ++rejected_;
  if (&channel == &laser_) host_.health().set(HealthState::kDegraded, "scan refused: " + reason);
}

/// False while the pitch of the scan's time is not known yet.
bool ScanFilterComponent::filter(Channel& channel, const sensor_msgs::msg::LaserScan& scan) {
  const runtime::Time stamp = wire::from_message(scan.header().stamp());
  const double duration = static_cast<double>(scan.time_increment()) *
                          (static_cast<double>(scan.ranges().size()) - 1.0);
  if (!(duration >= 0.0 && duration <= kLongestScan)) {
    refuse(channel, "the scan must take 0 to 0.2 s, got " + std::to_string(duration) + " s");
    return true;
  }
  const auto at_first = pitch_.at(stamp);
  const auto at_last = pitch_.at(stamp + runtime::from_seconds(duration));
  if (!at_first || !at_last) return false;
  const ScanGeometry geometry{scan.angle_min(), scan.angle_increment(), scan.range_min(),
                              scan.range_max()};
  const auto filtered =
      channel.filter->filter(geometry, scan.ranges(), *at_first, *at_last, channel.planar);
  if (!filtered) {
    refuse(channel, filtered.error());
    return true;
  }
  const FilterCounts& counts = laser_.filter->counts();
  floor_ = counts.floor, high_ = counts.high, mixed_ = counts.mixed, invalid_ = counts.invalid;
  if (!channel.placed) {
    channel.placed = true;
    place_frames();
  }
  const PlanarScan& planar = channel.planar;
  sensor_msgs::msg::LaserScan message;
  message.header(wire::header(stamp, channel.frame));
  message.angle_min(static_cast<float>(planar.geometry.angle_min));
  message.angle_increment(static_cast<float>(planar.geometry.angle_increment));
  message.angle_max(static_cast<float>(planar.geometry.angle_min +
                                       planar.geometry.angle_increment *
                                           (static_cast<double>(planar.ranges.size()) - 1.0)));
  message.scan_time(scan.scan_time());
  message.range_min(static_cast<float>(planar.geometry.range_min));
  message.range_max(static_cast<float>(planar.geometry.range_max));
  message.ranges(planar.ranges);
  channel.output.publish(message);
  if (&channel == &laser_) {
    laser_left_ = host_.now();
    if (scan_.fresh() != nullptr) host_.health().set(HealthState::kOk);
  }
  return true;
}

void ScanFilterComponent::place_frames() {
  tf2_msgs::msg::TFMessage message;
  for (const Channel* channel : {&laser_, &ultrasonic_}) {
    if (!channel->placed) continue;
    message.transforms().push_back(
        wire::transform(host_.now(), frames::kBaseFootprint, channel->frame,
                        geometry::to_space(channel->planar.base_T_scan)));
  }
  frames_.publish(message);
}

}  // namespace usher::scan_filter
