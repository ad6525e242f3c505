#include "interaction/speech/core/wav_file.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <string_view>

namespace usher::speech {

namespace {

constexpr std::size_t kMostBytes = 64U << 20U;
constexpr std::size_t kChunkHeader = 8;
constexpr std::size_t kFormatSize = 16;
constexpr std::uint16_t kLinear = 1, kExtensible = 0xFFFE;

std::uint16_t u16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8U));
}
std::uint32_t u32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return u16(bytes, at) | (static_cast<std::uint32_t>(u16(bytes, at + 2)) << 16U);
}
bool tagged(std::span<const std::uint8_t> bytes, std::size_t at, std::string_view tag) {
  return std::equal(tag.begin(), tag.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

struct Format {
  int channels = 0;
  int rate = 0;
};

Result<Format> parse_format(std::span<const std::uint8_t> chunk) {
  if (chunk.size() < kFormatSize)
    return Error{"expected a format of 16 bytes, got " + std::to_string(chunk.size())};
  const auto coding = u16(chunk, 0), channels = u16(chunk, 2), bits = u16(chunk, 14);
  const auto rate = u32(chunk, 4);
  if ((coding != kLinear && coding != kExtensible) || bits != 16)
    return Error{"expected linear samples of 16 bit, got coding " + std::to_string(coding) +
                 " with " + std::to_string(bits) + " bit"};
  if (channels < 1 || channels > kMostChannels)
    return Error{"expected 1 to 8 channels, got " + std::to_string(channels)};
  if (rate < kLowestRate || rate > kHighestRate)
    return Error{"expected a rate in [4000, 192000] Hz, got " + std::to_string(rate)};
  return Format{channels, static_cast<int>(rate)};
}

void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}
void put(std::vector<std::uint8_t>& bytes, std::string_view tag) {
  for (const char letter : tag) bytes.push_back(static_cast<std::uint8_t>(letter));
}

}  // namespace

Result<Sound> parse_wav(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kRiffHeader = 12;
  if (bytes.size() < kRiffHeader || !tagged(bytes, 0, "RIFF") || !tagged(bytes, 8, "WAVE"))
    return Error{"expected a RIFF WAVE file, got " + std::to_string(bytes.size()) + " other bytes"};
  std::optional<Format> format;
  for (std::size_t at = kRiffHeader; bytes.size() - at >= kChunkHeader;) {
    const std::size_t begin = at + kChunkHeader;
    const std::size_t size = std::min<std::size_t>(u32(bytes, at + 4), bytes.size() - begin);
    const auto chunk = bytes.subspan(begin, size);
    if (tagged(bytes, at, "fmt ")) {
      const auto parsed = parse_format(chunk);
      if (!parsed) return Error{parsed.error()};
      format = *parsed;
    } else if (tagged(bytes, at, "data")) {
      if (!format) return Error{"expected the format before the samples"};
      const auto channels = static_cast<std::size_t>(format->channels);
      Sound sound{format->rate, {}};
      sound.samples.reserve(size / (2 * channels));
      for (std::size_t i = 0; i + 2 * channels <= size; i += 2 * channels) {
        int sum = 0;
        for (std::size_t c = 0; c < channels; ++c)
          sum += static_cast<std::int16_t>(u16(chunk, i + 2 * c));
        sound.samples.push_back(static_cast<std::int16_t>(sum / format->channels));
      }
      return sound;
    }
    at = begin + size + (size & 1U);  // chunks begin at even places
    if (at > bytes.size()) break;
  }
  return Error{"expected a chunk of samples, got none"};
}

std::vector<std::uint8_t> write_wav(const Sound& sound) {
  const auto size = static_cast<std::uint32_t>(2 * sound.samples.size());
  const auto rate = static_cast<std::uint32_t>(sound.rate);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(44 + size);
  put(bytes, "RIFF");
  put(bytes, 36 + size, 4);
  put(bytes, "WAVEfmt ");
  put(bytes, kFormatSize, 4);
  put(bytes, kLinear, 2);
  put(bytes, 1, 2);
  put(bytes, rate, 4);
  put(bytes, 2 * rate, 4);
  put(bytes, 2, 2);
  put(bytes, 16, 2);
  put(bytes, "data");
  put(bytes, size, 4);
  for (const std::int16_t sample : sound.samples) put(bytes, static_cast<std::uint16_t>(sample), 2);
  return bytes;
}

Result<Sound> read_wav_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{path + ": cannot be opened"};
  std::vector<std::uint8_t> bytes;
  for (char c = 0; bytes.size() < kMostBytes && file.get(c);)
    bytes.push_back(static_cast<std::uint8_t>(c));
  auto sound = parse_wav(bytes);
  if (!sound) return Error{path + ": " + sound.error()};
  return sound;
}

Status write_wav_file(const std::string& path, const Sound& sound) {
  const auto bytes = write_wav(sound);
  std::ofstream file(path, std::ios::binary);
  for (const std::uint8_t byte : bytes) file.put(static_cast<char>(byte));
  file.close();
  if (!file) return Error{path + ": cannot be written"};
  return {};
}

}  // namespace usher::speech
