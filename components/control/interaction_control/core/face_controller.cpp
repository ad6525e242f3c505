#include "control/interaction_control/core/face_controller.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "foundation/geometry/angle.hpp"

namespace usher::interaction_control {

FaceController::FaceController(const Parameters& parameters) : parameters_(parameters) {
  assert(parameters.dead_zone > 0.0 && parameters.resume_zone > parameters.dead_zone);
  assert(parameters.gain > 0.0 && parameters.max_rate >= parameters.min_rate);
}

void FaceController::face(double yaw) {
  if (!std::isfinite(yaw)) {
    stand();
    return;
  }
  mode_ = Mode::kFace;
  goal_ = yaw;
}

void FaceController::search(bool left) {
  mode_ = Mode::kSearch;
  left_ = left;
}

void FaceController::stand() {
  mode_ = Mode::kStand;
  turning_ = false;
}

double FaceController::step(double yaw) {
  if (mode_ == Mode::kStand || !std::isfinite(yaw)) return 0.0;
  if (mode_ == Mode::kSearch) return left_ ? parameters_.search_rate : -parameters_.search_rate;
  const double error = geometry::shortest_turn(yaw, goal_);
  const double size = std::abs(error);
  turning_ = size > (turning_ ? parameters_.dead_zone : parameters_.resume_zone);
  if (!turning_) return 0.0;
  return std::copysign(
      std::clamp(parameters_.gain * size, parameters_.min_rate, parameters_.max_rate), error);
}

}  // namespace usher::interaction_control
