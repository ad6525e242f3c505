#include "drivers/segway_rmp/shell/sim_feedback.hpp"

#include "wire/conversions.hpp"

namespace usher::segway_rmp {

SegwayFeedback from_message(const usher_sim_msgs::msg::BaseFeedback& message) {
  SegwayFeedback feedback;
  feedback.stamp = wire::from_message(message.header().stamp()).time_since_epoch();
  feedback.mode = message.emergency()   ? Mode::kEmergency
                  : message.balancing() ? Mode::kBalancing
                                        : Mode::kStandby;
  feedback.pitch = message.pitch();
  feedback.pitch_rate = message.pitch_rate();
  feedback.yaw_rate = message.yaw_rate();
  feedback.left_velocity = message.left_velocity();
  feedback.right_velocity = message.right_velocity();
  feedback.left_travel = message.left_travel();
  feedback.right_travel = message.right_travel();
  feedback.battery_percent = message.battery_percent();
  return feedback;
}

}  // namespace usher::segway_rmp
