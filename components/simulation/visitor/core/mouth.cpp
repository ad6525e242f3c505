#include "simulation/visitor/core/mouth.hpp"

#include <algorithm>
#include <cmath>

namespace usher::visitor {

namespace {

/// 20 dB below a voice of 62 dB, as the thesis' room of 42 dB; espeak-ng's is about 4000.
constexpr double kNoise = 400.0;  ///< root mean square of a sample, full scale 32767
constexpr double kMost = 32767.0;

}  // namespace

void Mouth::say(std::vector<std::int16_t> samples) {
  samples_ = std::move(samples);
  at_ = 0;
}

std::vector<std::uint8_t> Mouth::next(std::size_t count, Random& random) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const double said = speaks() ? samples_[at_++] : 0.0;
    const auto sample = static_cast<std::uint16_t>(
        std::lround(std::clamp(said + kNoise * random.gaussian(), -kMost, kMost)));
    bytes.push_back(static_cast<std::uint8_t>(sample & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(sample >> 8U));
  }
  return bytes;
}

}  // namespace usher::visitor
