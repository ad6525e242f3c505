#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/api/host.hpp"
#include "simulation/rendering/core/painter.hpp"
#include "simulation/world/core/depth_scan_model.hpp"
#include "simulation/world/core/face_model.hpp"
#include "simulation/world/core/people_model.hpp"

namespace usher::world {

/// The simulated depth cameras' side of the world component: pixels, or the scans and the people
/// that the fitted models make without them, at 30 Hz (rear camera and people 15, faces 10), the
/// two cameras in turn. Stamps are those of the world's steps; an image is rendered beside the
/// handlers; its depths come two turns later, as regularly as from a camera, its colors before.
class DepthOutput {
 public:
  /// `world` is null while the component is only described; it must outlive this.
  DepthOutput(runtime::Host& host, const World* world, std::uint64_t seed);

  void set_tilt(double servo) { kinect_.set_tilt(servo); }
  double tilt() const { return kinect_.tilt(); }  ///< [rad]
  /// One step of the world has passed, now.
  void step(runtime::Time now);

 private:
  enum class Kind { kOff, kModel, kPixels };
  static DepthCameraConfig read_kinect(runtime::Parameters& parameters);
  static DepthCameraConfig read_rear(runtime::Parameters& parameters);
  void read_faces();
  void publish_next();
  void publish_info();
  void publish_kinect();
  void publish_rear();
  struct Shot;
  struct Pixels;
  void take(Pixels& pixels);
  void render(Pixels& pixels, Shot& shot);
  void deliver(Pixels& pixels);
  void publish(Pixels& pixels, Shot& shot);
  void publish_scan(const std::vector<float>& ranges, const char* frame,
                    runtime::Output<sensor_msgs::msg::LaserScan>& output);
  void publish_people(PeopleModel& model, const DepthCamera& camera, const char* frame,
                      runtime::Output<usher_sim_msgs::msg::Sightings>& output);
  void publish_faces();

  runtime::Host& host_;
  const World* world_;
  Kind kind_ = Kind::kOff;
  bool has_rear_ = true;
  int every_ = 1;         ///< only every n-th image is rendered
  int colors_every_ = 1;  ///< and every n-th one painted
  DepthCamera kinect_, rear_;
  std::optional<DepthScanModel> kinect_model_, rear_model_;
  std::optional<PeopleModel> kinect_people_model_, rear_people_model_;
  std::optional<FaceModel> face_model_;
  WorldRenderer renderer_;
  std::optional<rendering::Painter> painter_;  // none: no color images
  runtime::Time stepped_{};                    ///< time of the world's last step
  bool told_ = false;                          ///< the intrinsics
  bool kinect_next_ = true;
  int images_ = 0;  ///< of both cameras
  /// An image that a camera took. While it is in work it belongs to the job that renders it, and so
  /// do the renderer, the painter and the two buffers.
  struct Shot {
    enum class State { kNone, kInWork, kReady } state = State::kNone;
    bool due = false;  ///< to be delivered as soon as it is ready
    bool painted = false;
    runtime::Time stamp{};
    Exposure exposure;
    WorldRenderer::Moment moment;
    std::vector<rendering::Gains> gains;  ///< for each of the people
    std::string error;
    sensor_msgs::msg::Image depth, color;
  };
  /// The rendered images of one camera.
  struct Pixels {
    DepthCamera& camera;
    const char* frame;
    std::array<Shot, 2> shots{};
    std::size_t newest = 0;
    runtime::Output<sensor_msgs::msg::Image> depths{}, colors{};
  };
  Pixels kinect_pixels_, rear_pixels_;
  std::vector<std::uint16_t> depth_;
  std::vector<std::uint8_t> rgb_;
  std::uint64_t& late_images_;  ///< left out since two before them are in work still
  DepthScanResult result_;
  sensor_msgs::msg::LaserScan scan_;
  std::vector<ModelledSighting> found_;
  std::vector<ModelledFace> seen_faces_;
  usher_msgs::msg::Faces faces_message_;
  usher_sim_msgs::msg::Sightings people_;
  runtime::Output<sensor_msgs::msg::CameraInfo> kinect_info_, rear_info_;
  runtime::Output<sensor_msgs::msg::LaserScan> kinect_scan_, kinect_low_, rear_scan_;
  runtime::Output<usher_sim_msgs::msg::Sightings> kinect_people_, rear_people_;
  runtime::Output<usher_msgs::msg::Faces> faces_;
  runtime::Timer timer_;
};

}  // namespace usher::world
