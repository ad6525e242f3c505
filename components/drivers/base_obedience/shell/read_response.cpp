#include "drivers/base_obedience/shell/read_response.hpp"

#include <string>

namespace usher::drive {

ResponseWatch::Parameters read_response(runtime::Parameters& parameters) {
  ResponseWatch::Parameters p;
  const auto period = [&](Time& value, const std::string& name, runtime::Range range,
                          const std::string& text) {
    value = runtime::from_seconds(
        parameters.number("robot.response." + name, "s", range, runtime::seconds(value), text));
  };
  const auto speed = [&](double& value, const std::string& name, const std::string& text) {
    value = parameters.number("robot.response." + name, "m/s", {0.05, 2}, value, text);
  };
  const auto turn_rate = [&](double& value, const std::string& name, const std::string& text) {
    value = parameters.number("robot.response." + name, "rad/s", {0.05, 3}, value, text);
  };
  period(p.response, "time", {0.2, 10}, "Within this the base gets from any command to any other.");
  speed(p.linear.threshold, "linear_threshold", "Velocity error above which the base disobeys.");
  period(p.linear.patience, "linear_patience", {0.1, 10}, "How long that error may last.");
  turn_rate(p.angular.threshold, "angular_threshold",
            "Turn rate error above which the base disobeys.");
  period(p.angular.patience, "angular_patience", {0.1, 10}, "How long that error may last.");
  speed(p.standing_linear, "standing_linear_threshold",
        "Velocity error where only a standstill was commanded for the response time.");
  turn_rate(p.standing_angular, "standing_angular_threshold",
            "Turn rate error where only a standstill was commanded for the response time.");
  return p;
}

}  // namespace usher::drive
