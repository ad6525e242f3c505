#pragma once

#include <algorithm>
#include <cmath>

#include "foundation/kinematics/torso.hpp"

namespace usher::interaction_control {

/// The eyes: colors fade into each other, and the brightness follows the robot's voice.
class Eyes {
 public:
  struct Parameters {
    double silent = 0.4;  ///< {0..1} brightness while nothing is said; a visitor of the thesis
                          ///< found the eyes too bright
    double fade = 0.5;    ///< [s] {> 0} from one color to another
    double blink = 0.12;  ///< [s] {> 0} from dark to full
  };

  explicit Eyes(const Parameters& parameters) : parameters_(parameters) {}

  /// Toward these colors; `level` of the voice {0..1}, what is not is silence.
  void step(const kinematics::EyeColor& left, const kinematics::EyeColor& right, double level,
            double seconds) {
    fade(left_, left, seconds / parameters_.fade);
    fade(right_, right, seconds / parameters_.fade);
    const double loud = std::isfinite(level) ? std::clamp(level, 0.0, 1.0) : 0.0;
    const double wanted = parameters_.silent + (1.0 - parameters_.silent) * loud;
    const double step = seconds / parameters_.blink;
    brightness_ = std::clamp(wanted, brightness_ - step, brightness_ + step);
  }

  kinematics::EyeColor left() const { return kinematics::dimmed(left_, brightness_); }
  kinematics::EyeColor right() const { return kinematics::dimmed(right_, brightness_); }

 private:
  static void fade(kinematics::EyeColor& color, const kinematics::EyeColor& to, double step) {
    const auto most = static_cast<float>(step);
    for (std::size_t i = 0; i < color.size(); ++i)
      color[i] = std::clamp(to[i], color[i] - most, color[i] + most);
  }

  Parameters parameters_;
  kinematics::EyeColor left_{}, right_{};
  double brightness_ = 0.0;
};

}  // namespace usher::interaction_control
