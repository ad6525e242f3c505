#pragma once

#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

/// The same sound at another rate, by a windowed sinc (Kaiser, 70 dB): what lies above 0.46 of the
/// lower rate is removed. The length is rounded up. Both rates in [4000, 192000] Hz.
Sound resampled(const Sound& sound, int rate);

/// For a recognizer of 16 kHz: like resampled(), but a sound of a telephone band (8 kHz, a
/// Bluetooth headset) gets the missing upper band as the mirror of the lower one, 25 dB weaker, as
/// speech has it; models trained on the whole band take emptiness there for no speech at all.
Sound for_recognizer(const Sound& sound);

}  // namespace usher::speech
