#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "perception/face_detector/core/face_detector.hpp"
#include "perception/face_detector/core/place.hpp"
#include "runtime/api/host.hpp"
#include "wire/transform_input.hpp"

namespace usher::face_detector {

/// Faces in the Kinect's images, with range and bearing: one message for each pair of a color and a
/// depth image that it takes. The search runs beside the handlers; pairs that arrive meanwhile
/// replace one another.
class FaceDetectorComponent final : public runtime::Component {
 public:
  explicit FaceDetectorComponent(runtime::Host& host);

 private:
  using Image = sensor_msgs::msg::Image;
  struct Pair {
    std::shared_ptr<const Image> color, depth;
    runtime::Time stamp;
  };
  /// What the job beside the handlers works on.
  struct Job {
    std::string cascade;
    FaceDetectorConfig config;
    std::optional<FaceDetector> detector;
    Pair pair;
    std::vector<std::uint8_t> rgb;
    std::vector<std::uint16_t> millimeters;
    std::vector<Face> faces;
    int width = 0, height = 0;
    std::string error;
    bool hopeless = false;  // no pair will ever do
    void run();
  };
  void take_info(const sensor_msgs::msg::CameraInfo& info);
  void take_images();
  void start(Pair pair);
  void finish();
  void publish(runtime::Time stamp, const geometry::Pose3& base_T_camera);

  runtime::Host& host_;
  std::shared_ptr<Job> job_ = std::make_shared<Job>();
  bool busy_ = false;
  std::optional<Pair> waiting_;
  std::optional<imaging::Intrinsics> intrinsics_;
  std::optional<geometry::Pose3> fixed_;  // none: the mount moves, tf tells where the camera is
  runtime::Duration period_{};
  runtime::Time last_{};
  usher_msgs::msg::Faces message_;
  std::uint64_t& rejected_;
  std::uint64_t& replaced_;

  wire::TransformInput transforms_;
  runtime::Input<sensor_msgs::msg::CameraInfo> info_;
  runtime::Input<Image> color_, depth_;
  runtime::Output<usher_msgs::msg::Faces> faces_;
};

}  // namespace usher::face_detector
