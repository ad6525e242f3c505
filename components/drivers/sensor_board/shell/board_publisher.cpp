#include "drivers/sensor_board/shell/board_publisher.hpp"

#include <cmath>
#include <utility>

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::sensor_board {

namespace {
constexpr const char* kFrame = "ultrasonic";
}  // namespace

BoardPublisher::BoardPublisher(runtime::Host& host, std::function<void(double)> set_tilt)
    : rejected_tilts_(host.health().counter("tilt commands: rejected")),
      ultrasonic_(host.output(topics::kUltrasonic)),
      whiskers_(host.output(topics::kWhiskers)),
      mount_(host.output(topics::kTfStatic)),
      tilt_(host.output(topics::kKinectTilt)),
      tilt_command_(
          host.input(topics::kKinectTiltCommand, {.optional = true},
                     [this, set_tilt = std::move(set_tilt)](const auto& command, const auto&) {
                       if (std::isfinite(command.servo())) {
                         set_tilt(command.servo());
                       } else {
                         ++rejected_tilts_;
                       }
                     })) {
  auto& p = host.parameters();
  ring_radius_ =
      static_cast<float>(p.number("robot.ultrasonic.mount_x", "m", {-2, 2},
                                  "Ring of the ultrasonic sensors ahead of the axle's middle."));
  spacing_ = static_cast<float>(p.number("robot.ultrasonic.spacing", "rad", {0.05, 1.6},
                                         "Angle between two ultrasonic sensors."));
  range_min_ =
      static_cast<float>(p.number("range_min", "m", {0, 1}, 0.15, "Nearer ranges are none."));
  range_max_ =
      static_cast<float>(p.number("range_max", "m", {1, 10}, 6.0, "Farther things are not seen."));
  filters_.fill(estimation::MedianFilter(static_cast<std::size_t>(
      p.integer("median_window", "-", {1, 15}, 3, "Rolling window of each ultrasonic sensor."))));
  geometry::Pose3 base_T_ring;
  base_T_ring.translation.z() = p.number("robot.ultrasonic.mount_z", "m", {-1, 3},
                                         "Ring of the ultrasonic sensors above the axle's middle.");
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      wire::transform(host.now(), frames::kBaseLink, kFrame, base_T_ring));
  mount_.publish(message);
}

void BoardPublisher::publish(const Reading& reading) {
  const runtime::Time stamp(reading.stamp);
  usher_msgs::msg::Whiskers whiskers;
  whiskers.header(wire::header(stamp, frames::kBaseLink));
  whiskers.front_left(reading.whiskers.front_left);
  whiskers.front_right(reading.whiskers.front_right);
  whiskers.back_left(reading.whiskers.back_left);
  whiskers.back_right(reading.whiskers.back_right);
  whiskers_.publish(whiskers);
  if (!reading.measured) return;

  usher_msgs::msg::CameraTilt tilt;
  tilt.header(wire::header(stamp, frames::kBaseLink));
  tilt.servo(reading.tilt);
  tilt_.publish(tilt);

  sensor_msgs::msg::LaserScan scan;
  const float outermost = spacing_ * static_cast<float>(kSonars - 1) / 2.0F;
  scan.angle_min(-outermost);
  scan.angle_max(outermost);
  scan.angle_increment(spacing_);
  scan.scan_time(static_cast<float>(1.0 / topics::kUltrasonic.rate_hz));
  scan.range_min(range_min_ + ring_radius_);
  scan.range_max(range_max_ + ring_radius_);
  scan.ranges().resize(kSonars);
  for (std::size_t i = 0; i < kSonars; ++i) {
    const auto median = filters_[i].update(reading.ranges[i], reading.stamp);
    scan.header(wire::header(runtime::Time(median.stamp), kFrame));  // of all: measured together
    scan.ranges()[i] = median.range + ring_radius_;                  // infinity and NaN stay
  }
  ultrasonic_.publish(scan);
}

}  // namespace usher::sensor_board
