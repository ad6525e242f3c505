#pragma once

#include <cstdint>
#include <span>

namespace usher::speech {

/// Root mean square over full scale; 0 for nothing.
double rms(std::span<const std::int16_t> samples);

/// The same in decibels below full scale, {-100..0}.
double loudness_db(std::span<const std::int16_t> samples);

/// Loudness as a level for eyes: -50 dB and less is 0, -10 dB and more is 1.
double level_of(double loudness_db);

}  // namespace usher::speech
