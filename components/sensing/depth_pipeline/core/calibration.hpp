#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/kinematics/tilt_servo.hpp"
#include "foundation/result/result.hpp"
#include "sensing/depth_pipeline/core/camera.hpp"

namespace usher::depth_pipeline {

/// The floor as one image shows it: y = m z + c in the camera's frame (thesis figure 4.15).
struct FloorLine {
  double down = 0.0;      ///< [rad] of the optical axis below the horizon, 4.24
  double height = 0.0;    ///< [m] of the camera over the floor, 4.24
  int samples = 0;        ///< pixels on the line
  double share = 0.0;     ///< of the valid pixels of the lower image that are on it
  double residual = 0.0;  ///< [m] root mean square height of all that could be floor
};

/// Finds the floor in the central columns by RANSAC and least squares (thesis 4.4.2). The fit is
/// one of inverse depth over the row, whose error does not grow with the distance. An error says
/// why the image shows no floor that one could measure by; one that is uneven is none.
Result<FloorLine> find_floor_line(const DepthImage& image, const Intrinsics& intrinsics);

/// One tilt position of the sweep.
struct TiltSample {
  double servo = 0.0;     ///< [rad]
  double angle = 0.0;     ///< [rad] of the camera on the body, positive up (4.25)
  double mount_z = 0.0;   ///< [m] above the axle (4.26, 4.27)
  double residual = 0.0;  ///< [m] of the floor
  int images = 0;
};

/// What the sweep says of the mount.
struct KinectCalibration {
  kinematics::TiltServo servo;  ///< equation 4.1
  double mount_z = 0.0;         ///< [m] above the axle when the camera is level
  double mount_z_slope = 0.0;   ///< [m/rad] rise with the angle
  double angle_residual = 0.0;  ///< [rad] root mean square over the positions used
  double mount_residual = 0.0;  ///< [m] the same
  std::vector<bool> used;       ///< of the samples; the others lie off both lines
};

/// Lines through all positions by RANSAC (thesis 4.4.2). Refused with the reason: fewer than five
/// positions, less than 10 deg of sweep, more than a third of them off the lines, lines that no
/// mount can have.
Result<KinectCalibration> fit_calibration(const std::vector<TiltSample>& samples);

/// Sweeps the servo: tells where it shall go, takes the images, and ends with one sample a
/// position. Knows no clock: whoever has the robot calls it for every image.
class TiltSweep {
 public:
  struct Config {
    /// [rad] of the servo; higher up the floor leaves the image of a camera 0.9 m high.
    double first = -0.349, last = 0.192;
    int positions = 11;    ///< {5..}
    int images = 12;       ///< {3..} of each position
    int settling = 12;     ///< images that are waited after the servo arrived
    int patience = 150;    ///< images without a usable floor until a position is given up
    double mount_x = 0.2;  ///< [m] ahead of the axle, measured by hand
    double axle = 0.235;   ///< [m]
  };
  TiltSweep(const Intrinsics& intrinsics, const Config& config);

  double wanted() const;  ///< [rad] where the servo shall go now
  bool done() const { return position_ == config_.positions; }
  double progress() const;  ///< {0..1}

  /// An image with the servo's position and the body's pitch at its time.
  void take(const DepthImage& image, double servo, double pitch);

  const std::vector<TiltSample>& samples() const { return samples_; }
  /// Why the last position without a sample had none; empty: all had.
  const std::string& complaint() const { return complaint_; }

 private:
  void finish_position();

  Intrinsics intrinsics_;
  Config config_;
  int position_ = 0;
  int waited_ = 0, tried_ = 0;
  std::vector<TiltSample> single_;
  std::vector<TiltSample> samples_;
  std::string complaint_;
};

}  // namespace usher::depth_pipeline
