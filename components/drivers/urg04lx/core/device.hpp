#pragma once

#include "drivers/laser_scanner/core/scan.hpp"

namespace usher::urg04lx {

using laser_scanner::Scan;
using laser_scanner::Time;

}  // namespace usher::urg04lx
