#pragma once

#include <memory>

#include "interaction/speech/shell/equipment.hpp"

namespace usher::speech {

/// ALSA: "default", "plughw:1,0", ... A name that ends in ".wav" is a file in its place: read as
/// the microphone in real time, then silence; written as the loudspeaker when it is closed (at most
/// ten minutes). "" and "none": no device, which is no error for the loudspeaker: it swallows.
std::unique_ptr<SoundCard> make_sound_card();

}  // namespace usher::speech
