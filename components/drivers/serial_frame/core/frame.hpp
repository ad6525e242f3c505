#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace usher::serial_frame {

/// CRC-16/CCITT-FALSE: polynomial 1021, initial FFFF, nothing reflected.
std::uint16_t crc16(std::span<const std::uint8_t> bytes);

/// The longest content of a frame, checksum not counted.
inline constexpr std::size_t kLongestContent = 240;

/// A frame on its way: content and CRC (low byte first), COBS-encoded so that zero occurs only as
/// the end [cheshire1999cobs].
struct Frame {
  std::array<std::uint8_t, kLongestContent + 5> bytes{};
  std::size_t size = 0;

  std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
};

/// `content` must not be longer than kLongestContent.
Frame encode(std::span<const std::uint8_t> content);

/// Finds frames in a byte stream. It joins at the next zero, so a lost or damaged byte costs one
/// frame. No allocation.
class FrameDecoder {
 public:
  /// Calls `on_content(span)` for each whole frame; the span is valid during the call.
  template <class OnContent>
  void feed(std::span<const std::uint8_t> bytes, OnContent&& on_content) {
    for (const std::uint8_t byte : bytes) {
      if (const auto content = take(byte)) on_content(*content);
    }
  }
  void reset();

  std::uint64_t damaged() const { return damaged_; }  ///< frames with a wrong length, code or CRC

 private:
  std::optional<std::span<const std::uint8_t>> take(std::uint8_t byte);
  std::optional<std::size_t> decode();

  std::array<std::uint8_t, kLongestContent + 4> coded_{};
  std::array<std::uint8_t, kLongestContent + 4> content_{};
  std::size_t filled_ = 0;
  bool overflow_ = false;
  std::uint64_t damaged_ = 0;
};

}  // namespace usher::serial_frame
