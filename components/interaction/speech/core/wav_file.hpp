#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "interaction/speech/core/sound.hpp"

namespace usher::speech {

inline constexpr int kLowestRate = 4000;     ///< [Hz]
inline constexpr int kHighestRate = 192000;  ///< [Hz]
inline constexpr int kMostChannels = 8;

/// RIFF WAVE of 16 bit linear samples; several channels are averaged. A data chunk that promises
/// more than there is (a recording that was cut off, a stream) gives what is there. The error says
/// what was expected and found.
Result<Sound> parse_wav(std::span<const std::uint8_t> bytes);

/// The same as bytes: one channel, 16 bit.
std::vector<std::uint8_t> write_wav(const Sound& sound);

/// Files; the error names the path. At most 64 MB are read.
Result<Sound> read_wav_file(const std::string& path);
Status write_wav_file(const std::string& path, const Sound& sound);

}  // namespace usher::speech
