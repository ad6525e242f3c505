#pragma once

#include "foundation/kinematics/tilt_servo.hpp"
#include "runtime/api/parameters.hpp"

namespace usher::wire {

/// How the servo tilts the Kinect, from the parameters robot.kinect.servo_gain and
/// robot.kinect.servo_offset. Without them the servo stands where the camera looks.
kinematics::TiltServo read_tilt_servo(runtime::Parameters& parameters);

}  // namespace usher::wire
