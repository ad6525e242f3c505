#pragma once

#include "drivers/kinect/core/recording.hpp"

namespace usher::kinect {

/// A Kinect v1 at the USB, through libfreenect. One in a process: the library's own thread reads
/// it.
class LiveKinect {
 public:
  /// kMillimeters: the depths are laid pixel by pixel on the colour image by the device's own
  /// calibration. kRaw11: as measured, 11 bits, not laid on anything.
  explicit LiveKinect(Values values) : values_(values) {}
  ~LiveKinect();
  LiveKinect(const LiveKinect&) = delete;
  LiveKinect& operator=(const LiveKinect&) = delete;

  /// The next pair of images; blocks, usually for 33 ms. The error says that there is no Kinect.
  Status read(Frame& depth, ColorFrame& color);

 private:
  Values values_;
};

}  // namespace usher::kinect
