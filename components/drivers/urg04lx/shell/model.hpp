#pragma once

#include "drivers/laser_scanner/shell/scan_publisher.hpp"

namespace usher::urg04lx {

inline constexpr laser_scanner::Model kModel{
    .range_min = 0.06, .range_max = 4.0, .silence = std::chrono::milliseconds(300)};

}  // namespace usher::urg04lx
