#pragma once

#include <cstdint>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::visitor {

/// What a microphone hears of a visitor in a quiet room: words when there are some, a little noise
/// all the time. One channel at kMouthRate.
class Mouth {
 public:
  static constexpr std::size_t kMouthRate = 16000;  ///< [Hz]

  /// Breaks off what is being said.
  void say(std::vector<std::int16_t> samples);
  bool speaks() const { return at_ < samples_.size(); }
  /// The next `count` samples, little-endian.
  std::vector<std::uint8_t> next(std::size_t count, Random& random);

 private:
  std::vector<std::int16_t> samples_;
  std::size_t at_ = 0;
};

}  // namespace usher::visitor
