#include "drivers/sensor_board/core/sonar_faults.hpp"

#include <algorithm>
#include <cmath>

namespace usher::sensor_board {

void SonarFaults::take(const Reading& reading) {
  if (!reading.measured) return;
  for (std::size_t i = 0; i < kSonars; ++i)
    in_a_row_[i] = std::isnan(reading.ranges[i]) ? std::min(in_a_row_[i] + 1, kPatience) : 0;
}

std::string SonarFaults::reason() const {
  std::string text;
  for (std::size_t i = 0; i < kSonars; ++i) {
    if (in_a_row_[i] < kPatience) continue;
    if (!text.empty()) text += ", ";
    text += "ultrasonic sensor " + std::to_string(i + 1) + " does not answer";
  }
  return text;
}

}  // namespace usher::sensor_board
