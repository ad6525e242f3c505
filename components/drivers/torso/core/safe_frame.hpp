#pragma once

#include <optional>

#include "drivers/torso/core/device.hpp"

namespace usher::torso {

/// Between whoever wants a pose and the servos: joints stay within their limits and move no faster
/// than their rates, whatever is asked. While nothing is asked they hold and the eyes dim, so that
/// who looks at the robot sees that nobody is at home.
class SafeFrame {
 public:
  struct Parameters {
    kinematics::TorsoLimits limits;
    double dim = 0.15;  ///< {0..1} of the eyes' brightness that is left while nothing is asked
    double fade = 1.0;  ///< [s] {> 0} from full to dim, and back
  };

  explicit SafeFrame(const Parameters& parameters) : parameters_(parameters) {}

  /// Where the joints are: from there it goes on, unless it knows already.
  void start_at(const kinematics::TorsoPose& measured);
  /// The servos may be anywhere from now on.
  void forget() { joints_.reset(); }

  /// What the servos shall be told now, `seconds` after the last call. `wanted` is null while
  /// nothing is asked, or what is asked is not finite. Nothing until it knows where the joints are.
  std::optional<TorsoFrame> step(const TorsoFrame* wanted, double seconds);

 private:
  Parameters parameters_;
  std::optional<kinematics::TorsoPose> joints_;
  TorsoFrame eyes_;  ///< as wanted last
  double brightness_ = 0.0;
};

}  // namespace usher::torso
