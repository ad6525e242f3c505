#include "drivers/p3dx/core/packet.hpp"

#include <algorithm>

namespace usher::p3dx {

namespace {

constexpr std::uint8_t kHeader1 = 0xFA;
constexpr std::uint8_t kHeader2 = 0xFB;
constexpr std::uint8_t kPositive = 0x3B;
constexpr std::uint8_t kNegative = 0x1B;
constexpr std::uint8_t kConfiguration = 0x20;
constexpr std::uint8_t kMinCount = 3;  // a type and the checksum

Frame finish(Frame frame) {
  frame.bytes[0] = kHeader1;
  frame.bytes[1] = kHeader2;
  frame.bytes[2] = static_cast<std::uint8_t>(frame.size - 1);
  const std::uint16_t sum = checksum({frame.bytes.data() + 3, frame.size - 3});
  frame.bytes[frame.size++] = static_cast<std::uint8_t>(sum >> 8);
  frame.bytes[frame.size++] = static_cast<std::uint8_t>(sum & 0xFF);
  return frame;
}

}  // namespace

std::uint16_t checksum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) sum += bytes[i] * 256U + bytes[i + 1];
  sum &= 0xFFFFU;
  if (i < bytes.size()) sum ^= bytes[i];
  return static_cast<std::uint16_t>(sum);
}

Frame encode(Command command) {
  Frame frame;
  frame.bytes[3] = static_cast<std::uint8_t>(command);
  frame.size = 4;
  return finish(frame);
}

Frame encode(Command command, int argument) {
  const int magnitude = std::min(argument < 0 ? -std::max(argument, -32767) : argument, 32767);
  Frame frame;
  frame.bytes[3] = static_cast<std::uint8_t>(command);
  frame.bytes[4] = argument < 0 ? kNegative : kPositive;
  frame.bytes[5] = static_cast<std::uint8_t>(magnitude & 0xFF);
  frame.bytes[6] = static_cast<std::uint8_t>(magnitude >> 8);
  frame.size = 7;
  return finish(frame);
}

bool Decoder::begins() const {
  return (size_ < 1 || buffer_[0] == kHeader1) && (size_ < 2 || buffer_[1] == kHeader2) &&
         (size_ < 3 || (buffer_[2] >= kMinCount && buffer_[2] <= kMaxCount));
}

void Decoder::drop(std::size_t count) {
  std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(count),
            buffer_.begin() + static_cast<std::ptrdiff_t>(size_), buffer_.begin());
  size_ -= count;
}

/// Whether a whole packet is held, at the front. What cannot begin one is dropped, so that less
/// than a longest packet is held otherwise.
bool Decoder::find() {
  while (true) {
    for (; !begins(); ++skipped_) drop(1);
    if (size_ < 3 || size_ < count() + 3) return false;
    const auto sum = static_cast<std::uint16_t>(buffer_[count() + 1] * 256 + buffer_[count() + 2]);
    if (buffer_[3] == kConfiguration || checksum({buffer_.data() + 3, count() - 2}) == sum)
      return true;
    ++damaged_;
    drop(1);
  }
}

}  // namespace usher::p3dx
