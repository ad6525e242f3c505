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

/// A time [s], not negative, as it is said and shown, in half minutes: 0 below a minute, each half
/// minute up to five, whole minutes from there on. "1 min" for 87 s would be half a minute wrong.
inline long rounded_half_minutes(double seconds) {
  if (seconds < 60.0) return 0;
  const double step = seconds < 300.0 ? 30.0 : 60.0;
  return static_cast<long>(std::round(std::min(seconds, 1e6) / step) * step / 30.0);
}

}  // namespace usher::phrases
