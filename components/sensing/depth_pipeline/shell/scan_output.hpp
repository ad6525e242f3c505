#pragma once

#include <cstdint>
#include <span>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "sensing/depth_pipeline/core/depth_pipeline.hpp"

namespace usher::depth_pipeline {

/// A scan as a message, in a frame on base_footprint that stays where the upright camera is.
class ScanOutput {
 public:
  /// `origin` [m] ahead of the axle in the camera's direction; `backward`: it looks back.
  struct Frame {
    const char* name;
    double origin;
    bool backward;
  };
  ScanOutput(runtime::Host& host, const topics::Topic<sensor_msgs::msg::LaserScan>& topic,
             const Frame& frame, double max_range);

  /// `drops`: of each bearing; empty: none.
  void publish(runtime::Time stamp, double angle_min, double increment,
               std::span<const float> ranges, std::span<const float> intensities,
               std::span<const Drop> drops = {});

  /// Where the scan's frame is.
  geometry_msgs::msg::TransformStamped place(runtime::Time stamp) const;

 private:
  Frame frame_;
  sensor_msgs::msg::LaserScan message_;
  runtime::Output<sensor_msgs::msg::LaserScan> output_;
};

inline constexpr const char* kKinectLevel = "kinect_level";
inline constexpr const char* kRearLevel = "rear_camera_level";

}  // namespace usher::depth_pipeline
