#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"

namespace usher::visitor {

/// Words to samples of 16 bit at Mouth::kMouthRate. One call at a time, on any thread.
class Voice {
 public:
  virtual ~Voice() = default;
  virtual Result<std::vector<std::int16_t>> say(const std::string& words) = 0;
};

}  // namespace usher::visitor
