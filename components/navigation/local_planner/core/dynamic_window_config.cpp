#include "foundation/result/bounds.hpp"
#include "navigation/local_planner/core/dynamic_window.hpp"

namespace usher::local_planner {

Status check(const DynamicWindowConfig& c) {
  const CriticWeights& w = c.weights;
  constexpr double kMost = 1e6;
  return within({
      {"pace", c.pace, 0.05, 3.0},
      {"slowest", c.slowest, 0.01, c.pace},
      {"careful_speed", c.careful_speed, 0.0, 3.0},
      {"clearance", c.clearance, 0.0, 0.5},
      {"disc_clearance", c.disc_clearance, 0.0, 2.0},
      {"tight_speed", c.tight_speed, c.slowest, c.pace},
      {"fastest_turn", c.fastest_turn, 0.05, 5.0},
      {"spot_turn", c.spot_turn, 0.05, 5.0},
      {"slowest_turn", c.slowest_turn, 0.01, c.spot_turn},
      {"tight_turn", c.tight_turn, 0.01, c.spot_turn},
      {"lateral_acceleration", c.lateral_acceleration, 0.05, 10.0},
      {"turn_stopping_time", c.turn_stopping_time, 0.05, 5.0},
      {"braking", c.braking, 0.1, 20.0},
      {"window", c.window, 0.02, 4.0},
      {"speed_samples", static_cast<double>(c.speed_samples), 3, 64},
      {"turn_samples", static_cast<double>(c.turn_samples), 3, 255},
      {"simulated_time", c.simulated_time, 1.0, 4.0},
      {"steps", static_cast<double>(c.steps), 6, 40},
      {"margin", c.margin, 0.0, 1.0},
      {"forward_point", c.forward_point, 0.0, 2.0},
      {"position_tolerance", c.position_tolerance, 0.02, 2.0},
      {"yaw_tolerance", c.yaw_tolerance, 0.01, 3.2},
      {"turn_first_angle", c.turn_first_angle, 0.3, 3.2},
      {"limits.acceleration", c.limits.acceleration, 0.05, 10.0},
      {"limits.deceleration", c.limits.deceleration, 0.05, 10.0},
      {"limits.angular_acceleration", c.limits.angular_acceleration, 0.05, 20.0},
      {"response.latency", c.response.latency, 0.0, 1.0},
      {"response.time_constant", c.response.time_constant, 0.0, 3.0},
      {"response.turn_time_constant", c.response.turn_time_constant, 0.0, 3.0},
      {"response.acceleration", c.response.acceleration, 0.05, 10.0},
      {"response.angular_acceleration", c.response.angular_acceleration, 0.05, 20.0},
      {"weights.path", w.path, 0.0, kMost},
      {"weights.goal", w.goal, 0.0, kMost},
      {"weights.alignment", w.alignment, 0.0, kMost},
      {"weights.goal_front", w.goal_front, 0.0, kMost},
      {"weights.obstacle", w.obstacle, 0.0, kMost},
      {"weights.moving_obstacle", w.moving_obstacle, 0.0, kMost},
      {"weights.speed", w.speed, 0.0, kMost},
      {"weights.twirling", w.twirling, 0.0, kMost},
      {"weights.smoothness", w.smoothness, 0.0, kMost},
      {"weights.oscillation", w.oscillation, 0.0, kMost},
  });
}

}  // namespace usher::local_planner
