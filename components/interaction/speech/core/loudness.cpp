#include "interaction/speech/core/loudness.hpp"

#include <algorithm>
#include <cmath>

namespace usher::speech {

double rms(std::span<const std::int16_t> samples) {
  if (samples.empty()) return 0.0;
  double sum = 0.0;
  for (const std::int16_t sample : samples) sum += static_cast<double>(sample) * sample;
  return std::sqrt(sum / static_cast<double>(samples.size())) / 32768.0;
}

double loudness_db(std::span<const std::int16_t> samples) {
  return 20.0 * std::log10(std::max(rms(samples), 1e-5));
}

double level_of(double loudness_db) { return std::clamp((loudness_db + 50.0) / 40.0, 0.0, 1.0); }

}  // namespace usher::speech
