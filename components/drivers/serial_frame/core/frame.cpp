#include "drivers/serial_frame/core/frame.hpp"

#include <algorithm>
#include <cassert>

namespace usher::serial_frame {

namespace {

constexpr std::array<std::uint16_t, 256> make_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned crc = i << 8;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000U) != 0 ? ((crc << 1) ^ 0x1021U) & 0xFFFFU : (crc << 1) & 0xFFFFU;
    }
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> kTable = make_table();

}  // namespace

std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    const auto index = static_cast<std::uint8_t>((crc >> 8) ^ byte);
    crc = static_cast<std::uint16_t>((crc << 8) ^ kTable[index]);
  }
  return crc;
}

Frame encode(std::span<const std::uint8_t> content) {
  assert(content.size() <= kLongestContent);
  const std::uint16_t crc = crc16(content);
  const std::uint8_t tail[] = {static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8)};
  Frame frame;
  std::size_t code = 0;  // where the length of the present block goes
  frame.size = 1;
  const auto close = [&frame, &code] {
    frame.bytes[code] = static_cast<std::uint8_t>(frame.size - code);
    code = frame.size++;
  };
  const auto put = [&frame, &close](std::uint8_t byte) {
    if (byte == 0) {
      close();
    } else {
      frame.bytes[frame.size++] = byte;
    }
  };
  // No block can reach 254 bytes, so the special full block never occurs here.
  static_assert(kLongestContent + 2 < 254);
  for (const std::uint8_t byte : content) put(byte);
  for (const std::uint8_t byte : tail) put(byte);
  frame.bytes[code] = static_cast<std::uint8_t>(frame.size - code);
  frame.bytes[frame.size++] = 0;
  return frame;
}

void FrameDecoder::reset() {
  filled_ = 0;
  overflow_ = false;
}

std::optional<std::size_t> FrameDecoder::decode() {
  std::size_t size = 0;
  for (std::size_t at = 0; at < filled_;) {
    const std::size_t block = coded_[at];  // never zero: zero ends a frame
    if (at + block > filled_) return std::nullopt;
    std::copy_n(coded_.begin() + static_cast<std::ptrdiff_t>(at) + 1, block - 1,
                content_.begin() + static_cast<std::ptrdiff_t>(size));
    size += block - 1;
    at += block;
    if (at < filled_ && block != 0xFF) content_[size++] = 0;
  }
  return size;
}

std::optional<std::span<const std::uint8_t>> FrameDecoder::take(std::uint8_t byte) {
  if (byte != 0) {
    if (filled_ < coded_.size()) {
      coded_[filled_++] = byte;
    } else {
      overflow_ = true;
    }
    return std::nullopt;
  }
  const std::size_t length = filled_;
  const auto size = overflow_ ? std::nullopt : decode();
  reset();
  if (length == 0) return std::nullopt;  // two ends in a row are no frame and no damage
  if (!size || *size < 3) {
    ++damaged_;
    return std::nullopt;
  }
  const std::span<const std::uint8_t> content(content_.data(), *size - 2);
  const unsigned crc = content_[*size - 2] | (static_cast<unsigned>(content_[*size - 1]) << 8);
  if (crc != crc16(content)) {
    ++damaged_;
    return std::nullopt;
  }
  return content;
}

}  // namespace usher::serial_frame
