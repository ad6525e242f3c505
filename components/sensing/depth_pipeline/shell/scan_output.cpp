#include "sensing/depth_pipeline/shell/scan_output.hpp"

#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/low_scan.hpp"

namespace usher::depth_pipeline {

namespace {
constexpr float kRangeMin = 0.05F;
}  // namespace

ScanOutput::ScanOutput(runtime::Host& host, const topics::Topic<sensor_msgs::msg::LaserScan>& topic,
                       const Frame& frame, double max_range)
    : frame_(frame), output_(host.output(topic)) {
  message_.scan_time(static_cast<float>(1.0 / topic.rate_hz));
  message_.range_min(kRangeMin);
  message_.range_max(static_cast<float>(max_range));
}

void ScanOutput::publish(runtime::Time stamp, double angle_min, double increment,
                         std::span<const float> ranges, std::span<const float> intensities,
                         std::span<const Drop> drops) {
  message_.header(wire::header(stamp, frame_.name));
  message_.angle_min(static_cast<float>(angle_min));
  message_.angle_increment(static_cast<float>(increment));
  message_.angle_max(
      static_cast<float>(angle_min + increment * (static_cast<double>(ranges.size()) - 1.0)));
  message_.ranges().assign(ranges.begin(), ranges.end());
  message_.intensities().assign(intensities.begin(), intensities.end());
  for (std::size_t i = 0; i < drops.size(); ++i) {
    if (drops[i] == Drop::kNone) continue;
    message_.intensities()[i] =
        drops[i] == Drop::kBehindFloor ? wire::kDropBehindFloor : wire::kDrop;
  }
  output_.publish(message_);
}

geometry_msgs::msg::TransformStamped ScanOutput::place(runtime::Time stamp) const {
  const geometry::Pose2 pose{frame_.backward ? -frame_.origin : frame_.origin, 0.0,
                             frame_.backward ? geometry::kPi : 0.0};
  return wire::transform(stamp, frames::kBaseFootprint, frame_.name, geometry::to_space(pose));
}

}  // namespace usher::depth_pipeline
