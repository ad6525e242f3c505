#pragma once

#include <optional>
#include <vector>

#include "sensing/depth_pipeline/core/confidence.hpp"
#include "sensing/depth_pipeline/shell/parameters.hpp"
#include "sensing/depth_pipeline/shell/scan_output.hpp"
#include "sensing/depth_pipeline/shell/tilt_control.hpp"

namespace usher::depth_pipeline {

/// Stands for the depth pipeline and both cameras where no pixels are rendered: takes the scans
/// that the world's fitted model makes, rates them like the real ones, turns the camera as usual.
class DepthPipelineSimComponent final : public runtime::Component {
 public:
  explicit DepthPipelineSimComponent(runtime::Host& host);

 private:
  struct Channel {
    std::optional<Confidence> confidence;
    std::size_t bearings = 0;
    double least_confidence = 0.0;
    runtime::Time rated{};  ///< stamp of the newest scan
    std::vector<float> ranges, intensities;
    std::optional<ScanOutput> output;
    runtime::Input<sensor_msgs::msg::LaserScan> input;
  };
  void take(Channel& channel, const sensor_msgs::msg::LaserScan& scan);
  void report();

  runtime::Host& host_;
  PipelineConfig config_;
  runtime::HealthState without_kinect_;
  TiltControl tilt_;
  std::uint64_t& rejected_;
  Channel kinect_, low_, rear_;
  bool rear_missing_ = false;  ///< the robot has one, which falls silent or never spoke
  runtime::Output<tf2_msgs::msg::TFMessage> frames_;
};

}  // namespace usher::depth_pipeline
