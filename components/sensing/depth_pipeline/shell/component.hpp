#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sensing/depth_pipeline/shell/parameters.hpp"
#include "sensing/depth_pipeline/shell/scan_output.hpp"
#include "sensing/depth_pipeline/shell/tilt_control.hpp"
#include "wire/pitch_input.hpp"

namespace usher::depth_pipeline {

/// Turns depth images of the Kinect and of the rear camera into scans and images of obstacles, with
/// the pitch and the tilt of each image's own time, and says where the cameras are. Event-driven.
class DepthPipelineComponent final : public runtime::Component {
 public:
  explicit DepthPipelineComponent(runtime::Host& host);

 private:
  using Image = sensor_msgs::msg::Image;

  /// One camera's way through the component.
  struct Camera {
    const char* name = "";
    const char* frame = "";  ///< of the processed image: x right, y down, z forward
    Mount mount;
    std::optional<DepthPipeline> pipeline;
    std::shared_ptr<const Image> waiting;  ///< for the pitch of its time
    std::vector<std::uint16_t> depth;
    Image processed;
    runtime::Input<Image> images;
    runtime::Input<sensor_msgs::msg::CameraInfo> info;
    runtime::Output<Image> output;
    std::optional<ScanOutput> scan, low;
  };

  void take_info(Camera& camera, const sensor_msgs::msg::CameraInfo& info);
  void take_image(Camera& camera);
  void process_waiting();
  void take_tilt(const usher_msgs::msg::CameraTilt& tilt);
  bool process(Camera& camera, const Image& image);
  void publish(Camera& camera, const DepthView& view, runtime::Time stamp);
  double angle_of(const Camera& camera) const;
  bool turning() const;

  runtime::Host& host_;
  PipelineConfig config_;
  TiltControl tilt_;
  wire::PitchInput pitch_;
  double mount_slope_ = 0.0;
  double rear_angle_ = 0.0;
  double far_ = 12.0;
  double servo_ = 0.0, servo_before_ = 0.0;
  std::uint64_t& rejected_;
  std::uint64_t& without_pitch_;
  std::uint64_t& while_turning_;
  std::uint64_t& refitted_;
  std::uint64_t& drops_;
  Camera kinect_, rear_;
  runtime::Input<usher_msgs::msg::CameraTilt> servo_reading_;
  runtime::Output<tf2_msgs::msg::TFMessage> frames_;
};

}  // namespace usher::depth_pipeline
