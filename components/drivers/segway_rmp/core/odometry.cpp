#include "drivers/segway_rmp/core/odometry.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>

namespace usher::segway_rmp {

Odometry::Odometry() : Odometry(Parameters{}) {}

Odometry::Odometry(const Parameters& parameters) : parameters_(parameters) {
  assert(parameters.wheel_radius > 0.0 && parameters.track > 0.0 && parameters.longest_step > 0.0);
}

/// The way of a wheel that was so fast when it was last heard.
bool Odometry::rolled_out(double travel, double velocity) const {
  constexpr double kSway = 0.1;  // [m] of a base that balances on the spot
  return std::abs(travel) <= kSway ||
         (travel * velocity > 0.0 &&
          std::abs(travel) <= parameters_.longest_stop * std::abs(velocity) + kSway);
}

bool Odometry::update(const SegwayFeedback& feedback) {
  const double values[] = {feedback.pitch,        feedback.pitch_rate,    feedback.left_travel,
                           feedback.right_travel, feedback.left_velocity, feedback.right_velocity};
  for (const double value : values) {
    if (!std::isfinite(value)) {
      ++rejected_;
      return false;
    }
  }
  const double left = feedback.left_travel - last_.left_travel;
  const double right = feedback.right_travel - last_.right_travel;
  const double lean = feedback.pitch - last_.pitch;
  const bool bridged = interrupted_ && rolled_out(left, last_.left_velocity) &&
                       rolled_out(right, last_.right_velocity);
  const bool first = !started_ || (interrupted_ && !bridged);
  const double fastest =
      std::max(std::abs(feedback.left_velocity), std::abs(feedback.right_velocity));
  if (first || bridged || left != 0.0 || right != 0.0 || fastest < parameters_.hangs_from)
    counted_at_ = feedback.stamp;
  started_ = true;
  interrupted_ = false;
  last_ = {feedback.left_travel, feedback.right_travel, feedback.left_velocity,
           feedback.right_velocity, feedback.pitch};
  if (!first && !bridged && std::abs(left) + std::abs(right) > 2.0 * parameters_.longest_step) {
    ++rejected_;
    return false;
  }
  if (feedback.stamp - counted_at_ > parameters_.hangs_after) {
    ++rejected_;
    return false;
  }

  const double turn_rate = (feedback.right_velocity - feedback.left_velocity) / parameters_.track;
  raw_twist_ = {0.5 * (feedback.left_velocity + feedback.right_velocity), turn_rate};
  twist_ = {raw_twist_.v + parameters_.wheel_radius * feedback.pitch_rate, turn_rate};
  if (first) return true;

  const double length = 0.5 * (left + right);
  const double turn = (right - left) / parameters_.track;
  // An arc of unit time.
  raw_pose_ = geometry::integrate(raw_pose_, {length, turn}, 1.0);
  pose_ = geometry::integrate(pose_, {length + parameters_.wheel_radius * lean, turn}, 1.0);
  return true;
}

void Odometry::interrupt() {
  interrupted_ = started_;
  twist_ = raw_twist_ = {};
}

void Odometry::resume(const Wheels& wheels) {
  last_ = wheels;
  started_ = true;
  interrupt();
}

std::string to_text(const Odometry::Wheels& wheels) {
  std::ostringstream text;
  text.precision(17);
  text << wheels.left_travel << ' ' << wheels.right_travel << ' ' << wheels.left_velocity << ' '
       << wheels.right_velocity << ' ' << wheels.pitch;
  return text.str();
}

std::optional<Odometry::Wheels> read_wheels(const std::string& text) {
  std::istringstream stream(text);
  Odometry::Wheels wheels;
  for (double* value : {&wheels.left_travel, &wheels.right_travel, &wheels.left_velocity,
                        &wheels.right_velocity, &wheels.pitch}) {
    if (!(stream >> *value) || !std::isfinite(*value)) return std::nullopt;
  }
  return wheels;
}

}  // namespace usher::segway_rmp
