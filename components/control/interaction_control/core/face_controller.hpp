#pragma once

#include <cstdint>

namespace usher::interaction_control {

/// How the robot turns on the spot toward whom it talks to (the thesis, section 6.2).
struct Parameters {
  double dead_zone = 0.14;    ///< [rad] {> 0} an error up to this is facing
  double resume_zone = 0.26;  ///< [rad] {> dead_zone} from this error on it turns again
  double gain = 1.5;          ///< [1/s] {> 0} turn rate per error
  double max_rate = 0.5;      ///< [rad/s] {> 0}
  double min_rate = 0.1;      ///< [rad/s] {0..max_rate} slower than this the base does not turn
  double search_rate = 0.25;  ///< [rad/s] {> 0} of the slow turn while nobody is found
};

/// Turns until it faces, then stands until the person has clearly moved: with two thresholds, so
/// that a person who sways does not make 90 kg sway too. Deterministic, no allocation.
class FaceController {
 public:
  explicit FaceController(const Parameters& parameters);

  /// Turn to `yaw` [rad], in the frame of step().
  void face(double yaw);
  /// Turn slowly on the spot, to the left or to the right.
  void search(bool left);
  void stand();

  /// What to turn with now [rad/s], where the robot's own yaw is `yaw`; zero when that is not
  /// finite.
  double step(double yaw);

  /// It faces what it was told to.
  bool faces() const { return mode_ == Mode::kFace && !turning_; }
  /// It turns to find somebody.
  bool searches() const { return mode_ == Mode::kSearch; }

 private:
  enum class Mode : std::uint8_t { kStand, kFace, kSearch };
  Parameters parameters_;
  Mode mode_ = Mode::kStand;
  double goal_ = 0.0;
  bool left_ = true;
  bool turning_ = false;
};

}  // namespace usher::interaction_control
