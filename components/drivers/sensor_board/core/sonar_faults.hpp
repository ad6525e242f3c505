#pragma once

#include <array>
#include <string>

#include "drivers/sensor_board/core/device.hpp"

namespace usher::sensor_board {

/// Which ultrasonic sensors do not answer: nothing but faults for a second. One that hears no echo
/// answers; whether it is deaf or before open space nobody can tell.
class SonarFaults {
 public:
  static constexpr int kPatience = 20;  ///< measurements in a row, at 20 Hz

  void take(const Reading& reading);
  /// In words, the sensors numbered from 1 from right to left; empty: all answer.
  std::string reason() const;

 private:
  std::array<int, kSonars> in_a_row_{};  ///< faults of each, kPatience at most
};

}  // namespace usher::sensor_board
