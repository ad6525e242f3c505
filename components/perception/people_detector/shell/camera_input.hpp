#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "perception/people_detector/core/clothes.hpp"
#include "perception/people_detector/shell/following.hpp"

namespace usher::people_detector {

/// The detector's parameters, with their units, ranges and texts.
DetectorConfig read_detector(runtime::Parameters& parameters);

/// One depth camera's way to the tracker: its images without floor and ceiling, each with the place
/// that the camera had at that time, and, beside some of them, color images that say how people are
/// dressed. A manifest without the camera or without its colors is no trouble.
class CameraInput {
 public:
  struct Port {
    const char* name;  ///< for people
    Source source;
    const topics::Topic<sensor_msgs::msg::Image>* images;
    const topics::Topic<sensor_msgs::msg::Image>* colors;
    const topics::Topic<sensor_msgs::msg::CameraInfo>* info;
  };
  /// `following` must outlive this.
  CameraInput(runtime::Host& host, Following& following, const Port& port,
              const DetectorConfig& config);
  CameraInput(const CameraInput&) = delete;
  CameraInput& operator=(const CameraInput&) = delete;

  /// Why the camera sees nobody; empty when it looks, or never did.
  std::string trouble() const;

 private:
  using Image = sensor_msgs::msg::Image;
  void take_info(const sensor_msgs::msg::CameraInfo& info);
  void take_image(std::shared_ptr<const Image> image);
  void look(const Image& image, runtime::Time stamp, const geometry::Pose2& odom_T_base,
            const geometry::Pose3& base_T_optical);
  void dress(const imaging::DepthImage& depth, const View& view, runtime::Time stamp);
  void refuse(const std::string& reason);

  runtime::Host& host_;
  Following& following_;
  Port port_;
  DetectorConfig config_;
  std::optional<DepthDetector> detector_;
  std::optional<Clothes> clothes_;
  std::vector<std::uint16_t> millimeters_;
  std::vector<std::uint8_t> rgb_;
  std::vector<Sighting> seen_;
  runtime::Time last_{};                ///< stamp of the newest image that was taken
  std::optional<runtime::Time> heard_;  ///< when it came
  runtime::Time looked_{};              ///< when an image was last looked at
  std::string refusal_;                 ///< of the newest image; empty: none
  std::uint64_t& rejected_;
  std::uint64_t& rejected_colors_;
  runtime::Input<Image> images_, colors_;
  runtime::Input<sensor_msgs::msg::CameraInfo> info_;
};

}  // namespace usher::people_detector
