#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "interaction/speech/core/sound.hpp"

struct SpeexPreprocessState_;

namespace usher::speech {

/// Presses steady noise (fans, motors) down in what a microphone hears, by the preprocessor of
/// speexdsp, which learns the noise's spectrum from what it hears, and needs about a second for it.
class NoiseSuppressor {
 public:
  static constexpr int kBlock = kSpeechRate / 50;  ///< [samples]

  NoiseSuppressor();

  /// Replaces a block of kBlock samples by what is left of the one before it: 20 ms late.
  void suppress(std::span<std::int16_t> block);

 private:
  struct Free {
    void operator()(SpeexPreprocessState_* state) const;
  };
  std::unique_ptr<SpeexPreprocessState_, Free> state_;
};

}  // namespace usher::speech
