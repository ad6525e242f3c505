#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sensing/depth_pipeline/core/tilt_history.hpp"
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
    bool structured_light = false;  ///< else time of flight
    std::optional<DepthPipeline> pipeline;
    std::shared_ptr<const Image> waiting;  ///< for the pitch of its time
    std::shared_ptr<const Image> newest;
    bool repeated = false;  ///< the newest shows, byte for byte, what the one before did
    std::vector<std::uint16_t> depth;
    Image processed;
    runtime::Time rated{};  ///< stamp of the newest image that was
    double rated_at = 0.0;  ///< [rad] its camera's angle
    std::string refused;    ///< why the newest image was; empty: it was not
    std::string withheld;   ///< why the newest image that gave no scan gave none
    /// Since then a scan is: the last one of an image that shows anything new, or the first image.
    std::optional<runtime::Time> due;
    bool delivered = false;  ///< a scan, ever
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
  void refuse(Camera& camera, const std::string& reason);
  void withhold(Camera& camera, std::uint64_t& counter, const std::string& reason);
  void publish(Camera& camera, const DepthView& view, runtime::Time stamp);
  std::optional<double> angle_at(Camera& camera, runtime::Time stamp);
  bool may_turn(runtime::Time stamp) const;
  std::string looks_elsewhere() const;
  std::string trouble(const Camera& camera) const;
  void report();

  runtime::Host& host_;
  PipelineConfig config_;
  runtime::HealthState without_kinect_{};
  TiltControl tilt_;
  wire::PitchInput pitch_;
  double mount_slope_ = 0.0;
  double rear_angle_ = 0.0;
  double far_ = 12.0;
  TiltHistory servo_;
  std::optional<runtime::Time> elsewhere_;  ///< since then the Kinect is not where it shall be
  bool rear_fitted_ = false;
  runtime::Time pitch_came_{};
  std::uint64_t& refused_tilts_;
  std::uint64_t& rejected_;
  std::uint64_t& without_pitch_;
  std::uint64_t& without_tilt_;
  std::uint64_t& while_turning_;
  std::uint64_t& blind_;
  std::uint64_t& frozen_;
  std::uint64_t& refitted_;
  std::uint64_t& drops_;
  Camera kinect_, rear_;
  runtime::Input<usher_msgs::msg::CameraTilt> servo_reading_;
  runtime::Output<tf2_msgs::msg::TFMessage> frames_;
};

}  // namespace usher::depth_pipeline
