#include "interaction/speech/core/noise_suppressor.hpp"

#include <speex/speex_preprocess.h>

#include <cassert>

namespace usher::speech {

namespace {

// Of the noise. Less leaves fricatives hidden; with 40 dB they are taken for noise (measured on the
// recordings that thresholds are chosen with).
constexpr int kSuppression = -25;  // [dB]

}  // namespace

void NoiseSuppressor::Free::operator()(SpeexPreprocessState_* state) const {
  speex_preprocess_state_destroy(state);
}

NoiseSuppressor::NoiseSuppressor() : state_(speex_preprocess_state_init(kBlock, kSpeechRate)) {
  int on = 1;
  int suppression = kSuppression;
  speex_preprocess_ctl(state_.get(), SPEEX_PREPROCESS_SET_DENOISE, &on);
  speex_preprocess_ctl(state_.get(), SPEEX_PREPROCESS_SET_NOISE_SUPPRESS, &suppression);
}

void NoiseSuppressor::suppress(std::span<std::int16_t> block) {
  assert(block.size() == static_cast<std::size_t>(kBlock));
  speex_preprocess_run(state_.get(), block.data());
}

}  // namespace usher::speech
