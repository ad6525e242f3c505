#pragma once

#include "drivers/laser_scanner/shell/scan_publisher.hpp"

namespace usher::lms100 {

inline constexpr laser_scanner::Model kModel{
    .range_min = 0.5, .range_max = 20.0, .silence = std::chrono::milliseconds(200)};

}  // namespace usher::lms100
