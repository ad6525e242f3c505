#pragma once

#include "drivers/laser_scanner/core/scan.hpp"

namespace usher::lms100 {

using laser_scanner::Scan;
using laser_scanner::Time;

}  // namespace usher::lms100
