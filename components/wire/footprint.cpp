#include "wire/footprint.hpp"

#include <utility>
#include <vector>

namespace usher::wire {

geometry::Footprint read_footprint(runtime::Host& host) {
  const auto numbers = host.parameters().numbers(
      "robot.footprint", "m", {-5, 5}, 6, 2 * geometry::Footprint::kMaxCorners,
      "Corners of the robot's outline on the floor in base_footprint: x, y, x, y, ...");
  if (numbers.empty()) return geometry::Footprint::rectangle(0.1, 0.1);
  if (numbers.size() % 2 != 0) {
    host.fault("robot.footprint must be pairs of x and y, got " + std::to_string(numbers.size()) +
               " numbers");
  }
  std::vector<geometry::Point2> corners;
  for (std::size_t i = 0; i < numbers.size(); i += 2)
    corners.emplace_back(numbers[i], numbers[i + 1]);
  auto footprint = geometry::Footprint::make(corners);
  if (!footprint) host.fault("robot.footprint: " + footprint.error());
  return std::move(footprint).value();
}

}  // namespace usher::wire
