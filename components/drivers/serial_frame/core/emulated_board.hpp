#pragma once

#include "drivers/serial_frame/core/dialogue.hpp"

namespace usher::serial_frame {

/// The other end of the line, for emulators and tests: greets when it is asked to, counts what it
/// heard, and hands on what is not the same for every board.
class EmulatedBoard {
 public:
  explicit EmulatedBoard(const Hello& says) : hello(says) {}

  /// What the host said; calls `on_content(span)` for what is neither hello nor heartbeat. Gives
  /// what the board answers.
  template <class OnContent>
  std::vector<std::uint8_t> hear(std::span<const std::uint8_t> bytes, OnContent&& on_content) {
    std::vector<std::uint8_t> answer;
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> content) {
      if (is_hello_request(content)) {
        ++hello_requests;
        append(answer, to_frame(sequence++, hello));
      } else if (content[0] == kHeartbeat) {
        ++heartbeats;
      } else {
        on_content(content);
      }
    });
    return answer;
  }
  static void append(std::vector<std::uint8_t>& bytes, const Frame& frame) {
    bytes.insert(bytes.end(), frame.span().begin(), frame.span().end());
  }

  Hello hello;
  std::uint8_t sequence = 0;  ///< of what it says next
  int hello_requests = 0;
  int heartbeats = 0;

 private:
  static constexpr std::uint8_t kHeartbeat = 0x21;
  FrameDecoder decoder_;
};

}  // namespace usher::serial_frame
