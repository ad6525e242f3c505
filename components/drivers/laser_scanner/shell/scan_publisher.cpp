#include "drivers/laser_scanner/shell/scan_publisher.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::laser_scanner {

namespace {
constexpr const char* kFrame = "laser";
}

ScanPublisher::ScanPublisher(runtime::Host& host, const Model& model)
    : scan_(host.output(topics::kScan)), mount_(host.output(topics::kTfStatic)) {
  auto& parameters = host.parameters();
  range_min_ = static_cast<float>(parameters.number("range_min", "m", {0, 5}, model.range_min,
                                                    "Nearer readings are not valid."));
  range_max_ = static_cast<float>(parameters.number("range_max", "m", {1, 100}, model.range_max,
                                                    "Farther readings are not valid."));
  geometry::Pose3 base_T_laser;
  base_T_laser.translation.x() =
      parameters.number("robot.laser.mount_x", "m", {-2, 2}, "Laser ahead of the axle's middle.");
  base_T_laser.translation.z() =
      parameters.number("robot.laser.mount_z", "m", {-1, 3}, "Laser above the axle's middle.");
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(
      wire::transform(host.now(), frames::kBaseLink, kFrame, base_T_laser));
  mount_.publish(message);
}

void ScanPublisher::publish(const Scan& scan) {
  repetition_.take(scan);
  if (repeats()) return;
  sensor_msgs::msg::LaserScan message;
  message.header(wire::header(runtime::Time(scan.stamp), kFrame));
  message.angle_min(static_cast<float>(scan.angle_min));
  message.angle_max(static_cast<float>(
      scan.angle_min + scan.angle_increment * (static_cast<double>(scan.ranges.size()) - 1.0)));
  message.angle_increment(static_cast<float>(scan.angle_increment));
  message.time_increment(static_cast<float>(scan.time_increment));
  message.scan_time(static_cast<float>(scan.scan_time));
  message.range_min(range_min_);
  message.range_max(range_max_);
  message.ranges(scan.ranges);
  message.intensities(scan.intensities);
  scan_.publish(message);
}

}  // namespace usher::laser_scanner
