#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "drivers/kinect/core/camera_model.hpp"
#include "drivers/kinect/core/recording.hpp"
#include "drivers/kinect/device_real/live_kinect.hpp"
#include "drivers/kinect/shell/camera_publisher.hpp"

namespace usher::kinect {

/// The driver: of a Kinect v1 at the USB, or over recorded frames, as they were recorded or round
/// and round. Reading and decoding happen beside the handlers.
class KinectComponent final : public runtime::Component {
 public:
  /// `reading`: how long a frame is read in simulation.
  explicit KinectComponent(runtime::Host& host,
                           runtime::Duration reading = std::chrono::milliseconds(10));

 private:
  /// What the job beside the handlers works on.
  struct Job {
    std::optional<LiveKinect> live;
    std::optional<Recording> recording;
    std::optional<Rectifier> rectifier;
    std::size_t index = 0;
    Frame read, rectified;
    ColorFrame color, rectified_color;  ///< empty: none
    Stamps stamps;                      ///< of a live one's images
    std::string error;
    void run();
    Status fetch();
    Status fetch_live();
  };
  void open();
  void start_reading();
  void watch_reading();
  void take_frame();
  runtime::Time measured();

  runtime::Host& host_;
  runtime::Duration reading_time_;
  CameraPublisher publisher_;
  imaging::Intrinsics intrinsics_;
  bool live_ = false;
  std::string folder_;
  Values values_ = Values::kMillimeters;
  bool repeat_ = true;
  std::shared_ptr<Job> job_ = std::make_shared<Job>();
  runtime::Time started_{};
  runtime::Time read_at_{};                  ///< when the newest read began
  runtime::Time arrived_{};                  ///< when the newest read ended
  runtime::Time again_{};                    ///< not before, after an error
  estimation::DeviceClock clock_{kCounter};  ///< of a live one
  bool reading_ = false, ready_ = false;
  std::uint64_t& rejected_;
  runtime::Timer timer_;
};

}  // namespace usher::kinect
