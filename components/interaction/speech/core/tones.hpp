#pragma once

#include <cstdint>

#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

/// Sounds that say something without words. The first four are the wire's
/// DialogueScreen_Constants TONE_*.
enum class Tone : std::uint8_t {
  kNone = 0,
  kMoving = 1,     ///< the robot is about to move
  kPlease = 2,     ///< it asks somebody to make way
  kCall = 3,       ///< it calls the visitor
  kListening = 4,  ///< it listens from now on: two notes up
  kHeard = 5,      ///< it listens no more: two notes down
};

/// Sine notes of a musical fifth or octave with soft edges, peak at -12 dB; empty for kNone.
Sound tone(Tone tone, int rate);

}  // namespace usher::speech
