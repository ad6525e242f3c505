#include "drivers/p3dx/shell/base_driver.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::p3dx {

namespace {

using runtime::HealthState;

/// So long the pose follows the last measured velocity.
constexpr double kLongestPrediction = 0.15;  // [s]
constexpr double kWheelRadius = 0.0975;      // [m]
constexpr const char* kRing = "ultrasonic";

}  // namespace

BaseDriver::BaseDriver(runtime::Host& host, drive::BaseDevice device)
    : host_(host),
      base_(host, std::move(device), kWheelRadius, [this] { predict(); }),
      ring_radius_(
          host.parameters().number("robot.ultrasonic.mount_x", "m", {-2, 2},
                                   "Ring of the ultrasonic sensors ahead of the axle's middle.")),
      ring_height_(
          host.parameters().number("robot.ultrasonic.mount_z", "m", {-1, 3},
                                   "Ring of the ultrasonic sensors above the axle's middle.")),
      mounts_(host.output(topics::kTfStatic)),
      sonar_(host.output(topics::kUltrasonic)) {
  place_frames();
}

void BaseDriver::place_frames() {
  geometry::Pose3 base_T_ring;
  base_T_ring.translation.z() = ring_height_;
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      wire::transform(host_.now(), frames::kBaseLink, kRing, base_T_ring));
  mounts_.publish(message);
}

void BaseDriver::take(const Feedback& feedback) {
  feedback_ = feedback;
  heard_ = true;
  host_.health().set(warning_.empty() ? HealthState::kOk : HealthState::kDegraded, warning_);
  take_sonar(feedback);
}

void BaseDriver::disconnected(const std::string& reason) {
  heard_ = false;
  base_.disconnected(reason);
}

void BaseDriver::predict() {
  if (!heard_) return;
  const Time now = host_.now().time_since_epoch();
  const double age = std::chrono::duration<double>(now - feedback_.stamp).count();
  if (age > kLongestPrediction) return;  // the frames grow old, and whoever needs them stops
  base_.publish_odometry(now, geometry::integrate(feedback_.pose, feedback_.twist, age),
                         feedback_.twist);
  base_.report({.stamp = feedback_.stamp,
                .state = static_cast<std::uint8_t>(feedback_.mode),
                .twist = feedback_.twist,
                .battery_percent = feedback_.battery_percent});
}

/// Sonars that fired together may have fired apart before, and a scan has one time.
void BaseDriver::take_sonar(const Feedback& feedback) {
  std::map<Time, std::array<float, kSonarSlots>> scans;
  for (std::size_t slot = 0; slot < kSonarSlots; ++slot) {
    if (std::isnan(feedback.sonar[slot])) continue;
    const auto median = filters_[slot].update(feedback.sonar[slot], feedback.stamp);
    const auto [scan, fresh] = scans.try_emplace(median.stamp);
    if (fresh) scan->second.fill(std::numeric_limits<float>::quiet_NaN());
    scan->second[slot] = median.range;
  }
  for (const auto& [stamp, ranges] : scans) publish_sonar(stamp, ranges);
}

void BaseDriver::publish_sonar(Time stamp, const std::array<float, kSonarSlots>& ranges) {
  constexpr float kRangeMin = 0.15F, kRangeMax = 5.0F;  // [m]
  constexpr float kTurn = 0.32F;                        // [s] from one firing to its next
  const auto ring = static_cast<float>(ring_radius_);
  sensor_msgs::msg::LaserScan scan;
  scan.header(wire::header(runtime::Time(stamp), kRing));
  scan.angle_min(static_cast<float>(-0.5 * geometry::kPi));
  scan.angle_max(static_cast<float>(0.5 * geometry::kPi));
  scan.angle_increment(static_cast<float>(kSonarSpacing));
  scan.scan_time(kTurn);
  scan.range_min(kRangeMin + ring);
  scan.range_max(kRangeMax + ring);
  for (const float range : ranges) scan.ranges().push_back(range + ring);
  sonar_.publish(scan);
}

}  // namespace usher::p3dx
