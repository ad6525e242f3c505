#pragma once

#include <memory>
#include <optional>

#include "idl/topics.hpp"
#include "perception/people_detector/core/leg_finder.hpp"
#include "runtime/api/host.hpp"
#include "wire/transform_input.hpp"

namespace usher::people_detector {

/// Knows who walks around the robot: legs in the scan, followed over time.
class PeopleDetectorComponent final : public runtime::Component {
 public:
  explicit PeopleDetectorComponent(runtime::Host& host);

 private:
  void take_map(const nav_msgs::msg::OccupancyGrid& message);
  void take_scan(std::shared_ptr<const sensor_msgs::msg::LaserScan> scan);
  void update(const sensor_msgs::msg::LaserScan& scan, runtime::Time stamp,
              const geometry::Pose2& odom_T_base);
  void publish(runtime::Time stamp);

  runtime::Host& host_;
  std::optional<LegFinder> legs_;
  std::optional<Tracker> tracker_;
  runtime::Time last_{};
  std::uint64_t& rejected_;

  wire::TransformInput transforms_;
  runtime::Input<nav_msgs::msg::OccupancyGrid> map_;
  runtime::Input<sensor_msgs::msg::LaserScan> scan_;
  runtime::Output<usher_msgs::msg::People> people_;
};

}  // namespace usher::people_detector
