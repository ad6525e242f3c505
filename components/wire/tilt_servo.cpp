#include "wire/tilt_servo.hpp"

namespace usher::wire {

kinematics::TiltServo read_tilt_servo(runtime::Parameters& parameters) {
  using Servo = kinematics::TiltServo;
  Servo servo;
  servo.gain =
      parameters.number("robot.kinect.servo_gain", "-", {Servo::kLeastGain, Servo::kMostGain},
                        servo.gain, "Equation 4.1: servo = gain times angle + offset.");
  servo.offset = parameters.number("robot.kinect.servo_offset", "rad",
                                   {-Servo::kMostOffset, Servo::kMostOffset}, servo.offset,
                                   "Equation 4.1: what the servo is set to for a level camera.");
  return servo;
}

}  // namespace usher::wire
