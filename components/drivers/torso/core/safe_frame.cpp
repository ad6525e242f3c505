#include "drivers/torso/core/safe_frame.hpp"

#include <algorithm>

namespace usher::torso {

void SafeFrame::start_at(const kinematics::TorsoPose& measured) {
  if (!joints_ && kinematics::finite(measured)) joints_ = measured;
}

std::optional<TorsoFrame> SafeFrame::step(const TorsoFrame* wanted, double seconds) {
  if (!joints_) return std::nullopt;
  const bool asked = wanted != nullptr && kinematics::finite(wanted->joints);
  if (asked) {
    eyes_ = *wanted;
    joints_ = kinematics::moved(*joints_, wanted->joints, parameters_.limits, seconds);
  }
  const double step = seconds / parameters_.fade;
  brightness_ = asked ? std::min(1.0, brightness_ + step)
                      : std::clamp(parameters_.dim, brightness_ - step, brightness_ + step);
  return TorsoFrame{*joints_, kinematics::dimmed(eyes_.left_eye, brightness_),
                    kinematics::dimmed(eyes_.right_eye, brightness_)};
}

}  // namespace usher::torso
