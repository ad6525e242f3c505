#include "sensing/depth_pipeline/shell/tilt_control.hpp"

#include <cmath>

#include "sensing/depth_pipeline/core/tilt_history.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"
#include "wire/tilt_servo.hpp"

namespace usher::depth_pipeline {

namespace {

using std::chrono::milliseconds;

constexpr auto kPeriod = milliseconds(100);
constexpr auto kHold = milliseconds(2000);

}  // namespace

TiltControl::TiltControl(runtime::Host& host) : host_(host) {
  auto& p = host.parameters();
  servo_ = wire::read_tilt_servo(p);
  wanted_ = servo_.servo_for(
      p.number("angle_at_start", "rad", {-0.35, 0.35}, -0.0873,
               "Of the camera, positive up, until the supervisor says how the robot is."));
  state_ = host.input(
      topics::kSupervisorStatus,
      {.max_age = milliseconds(2000), .on_loss = "the camera keeps its angle", .optional = true},
      [this](const auto& status, const auto&) {
        wanted_ = servo_.servo_for(static_cast<double>(status.kinect_angle()));
      });
  request_ = host.input(topics::kKinectTiltRequest, {.optional = true},
                        [this](const auto& request, const auto&) {
                          if (!std::isfinite(request.servo())) return;
                          held_ = std::clamp(request.servo(), -kinematics::TiltServo::kLimit,
                                             kinematics::TiltServo::kLimit);
                          held_until_ = host_.now() + kHold;
                          command();
                        });
  command_ = host.output(topics::kKinectTiltCommand);
  timer_ = host.timer("tilt", kPeriod, [this](auto) { command(); });
}

void TiltControl::command() {
  usher_msgs::msg::CameraTilt message;
  message.header(wire::header(host_.now(), frames::kBaseLink));
  const double servo = host_.now() < held_until_ ? held_ : wanted_;
  if (!order_ || std::abs(servo - order_->servo) > TiltHistory::kStill)
    order_ = Order{servo, host_.now()};
  message.servo(servo);
  command_.publish(message);
}

}  // namespace usher::depth_pipeline
