#pragma once

#include <cstdint>
#include <vector>

namespace usher::speech {

/// One channel of sound, linear, full scale = 32767.
struct Sound {
  int rate = 16000;  ///< [Hz]
  std::vector<std::int16_t> samples;
  bool suppressed = false;  ///< noise was taken out of it

  double duration() const { return static_cast<double>(samples.size()) / rate; }  ///< [s]
};

/// What the recognizer's models were trained for.
inline constexpr int kSpeechRate = 16000;  ///< [Hz]

}  // namespace usher::speech
