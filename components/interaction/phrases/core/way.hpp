#pragma once

#include <algorithm>
#include <cmath>

namespace usher::phrases {

/// A way [m], not negative, as it is said and shown: whole metres, beyond 20 m in steps of 5, since
/// nobody wants to hear "37 metres".
inline long rounded_way(double meters) {
  const double step = meters > 20.0 ? 5.0 : 1.0;
  return static_cast<long>(std::round(std::min(meters, 1e6) / step) * step);
}

/// [s] A time from here on is said and shown in minutes.
inline constexpr double kInMinutesFrom = 45.0;

}  // namespace usher::phrases
