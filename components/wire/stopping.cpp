#include "wire/stopping.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace usher::wire {

kinematics::StoppingDistance read_stopping(runtime::Host& host) {
  auto& p = host.parameters();
  const auto speeds = p.numbers("robot.stopping.speeds", "m/s", {0, 5}, 1, 20, {1.0, 1.4},
                                "Speeds at which the stopping distance was measured, rising.");
  const auto distances = p.numbers("robot.stopping.distances", "m", {0, 20}, 1, 20, {1.48, 2.08},
                                   "Measured stopping distances, one for each speed.");
  std::vector<kinematics::StoppingPoint> points;
  for (std::size_t i = 0; i < std::min(speeds.size(), distances.size()); ++i) {
    points.push_back({speeds[i], distances[i]});
  }
  auto measured = kinematics::StoppingDistance::make(points);
  if (speeds.size() != distances.size()) {
    host.fault("robot.stopping must have as many distances as speeds, got " +
               std::to_string(speeds.size()) + " in robot.stopping.speeds and " +
               std::to_string(distances.size()) + " in robot.stopping.distances");
  }
  if (!measured) host.fault("robot.stopping: " + measured.error());
  return std::move(measured).value();
}

}  // namespace usher::wire
