#pragma once

#include "drivers/kinect/core/device_clock.hpp"
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

  /// The newest pair of images that nobody has read, or the next one; blocks, usually for up to
  /// 33 ms, and for ever when the device falls silent or is unplugged. The error says that there is
  /// no Kinect.
  Result<Stamps> read(Frame& depth, ColorFrame& color);

 private:
  Values values_;
};

}  // namespace usher::kinect
