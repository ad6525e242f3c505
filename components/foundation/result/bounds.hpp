#pragma once

#include <array>
#include <cstdio>
#include <initializer_list>

#include "foundation/result/result.hpp"

namespace usher {

/// A value and the closed range in which it must lie; NaN lies in none.
struct Bound {
  const char* name;
  double value, low, high;
  const char* unit = "";
};

/// The first value outside its range as an error: `sigma_hit must be in [0.005, 1] m, got 5`.
inline Status within(std::initializer_list<Bound> bounds) {
  for (const Bound& b : bounds) {
    if (b.value >= b.low && b.value <= b.high) continue;
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), "%s must be in [%g, %g]%s%s, got %g", b.name, b.low,
                  b.high, *b.unit != '\0' ? " " : "", b.unit, b.value);
    return Error{text.data()};
  }
  return {};
}

}  // namespace usher
