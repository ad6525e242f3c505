#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/serial_frame/core/frame.hpp"

namespace usher::serial_frame {

/// Time on the local monotonic clock.
using Time = std::chrono::nanoseconds;

/// What a board says of itself at boot and on request.
struct Hello {
  std::uint8_t protocol_version = 0;
  std::array<std::uint8_t, 3> firmware{};  ///< major, minor, patch
  std::uint32_t serial_number = 0;
  std::array<std::uint8_t, 2> parts{};  ///< how many it has of its two kinds of parts
};

/// A kind of part, and how many of it a board must have.
struct Parts {
  std::uint8_t count = 0;
  const char* name = "";
};

/// Bits of a board's status that all boards share.
inline constexpr std::uint8_t kWatchdogExpired = 0x01;  ///< the host was silent
inline constexpr std::uint8_t kRebooted = 0x80;         ///< since its last Hello

/// Nothing when it is none.
std::optional<Hello> parse_hello(std::span<const std::uint8_t> content);
bool is_hello_request(std::span<const std::uint8_t> content);

Frame hello_request(std::uint8_t sequence);
Frame heartbeat(std::uint8_t sequence);
Frame to_frame(std::uint8_t sequence, const Hello& hello);

/// What a host and a board say to each other whatever the board is for: greets it once it has
/// booted and again when it restarted, refuses another board, keeps its watchdog content, and knows
/// what was lost and whether it is there.
class Dialogue {
 public:
  struct Parameters {
    Time boot = std::chrono::seconds(2);  ///< opening the line restarts the board
    Time heartbeat = std::chrono::milliseconds(100);
    Time silence = std::chrono::milliseconds(300);  ///< then nothing is known any more
  };

  /// `parts`: what the right board has.
  Dialogue(const Parameters& parameters, const std::array<Parts, 2>& parts)
      : parameters_(parameters), parts_(parts) {}

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_content(span)` for each whole frame that is no hello.
  template <class OnContent>
  void received(std::span<const std::uint8_t> bytes, OnContent&& on_content) {
    if (!open_) return;
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> content) {
      if (!take_hello(content)) on_content(content);
    });
  }
  /// That frame made sense; counts what is missing before it.
  void count(std::uint8_t sequence);
  /// It made none.
  void reject() { ++rejected_; }
  /// Readings came with this status. False while nobody knows whether it is the right board: until
  /// it is greeted, and again when it restarted.
  bool believes(std::uint8_t status, Time now);

  /// Time passed: greets, feeds the watchdog. Call it at 20 Hz or more.
  void tick(Time now);
  /// Sends a frame of the board's own protocol.
  void send(const Frame& frame);
  std::uint8_t next_sequence() { return sequence_++; }
  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output();

  /// It said hello, and is the right one.
  bool greeted() const { return greeted_ && refusal_.empty(); }
  /// All hellos of this board: one more, and it may have forgotten what it was told.
  std::uint64_t hellos() const { return hellos_; }
  /// Readings came since it was greeted.
  bool heard() const { return heard_at_.has_value(); }
  /// Readings come as they should.
  bool healthy(Time now) const;
  /// Why they do not; empty when they do. `silent`: what to say when they came once.
  std::string reason(Time now, const char* silent) const;

  std::uint8_t status() const { return status_; }
  std::uint64_t lost_messages() const { return lost_messages_; }  ///< by the sequence
  std::uint64_t rejected() const { return rejected_; }            ///< whole frames without sense
  std::uint64_t damaged() const { return decoder_.damaged(); }

 private:
  bool take_hello(std::span<const std::uint8_t> content);

  Parameters parameters_;
  std::array<Parts, 2> parts_;
  FrameDecoder decoder_;
  bool open_ = false;
  bool greeted_ = false;
  Time opened_at_{};
  std::optional<Time> hello_sent_;
  std::optional<Time> heartbeat_sent_;
  std::optional<Time> heard_at_;
  std::optional<std::uint8_t> last_sequence_;
  std::uint8_t sequence_ = 0;  ///< of what is sent
  std::uint8_t status_ = 0;
  std::string refusal_;  ///< why the board is not usable at all
  std::vector<std::uint8_t> output_;
  std::uint64_t hellos_ = 0;
  std::uint64_t lost_messages_ = 0;
  std::uint64_t rejected_ = 0;
};

/// What a bit of a status means.
struct Trouble {
  std::uint8_t bit = 0;
  const char* meaning = "";
};
/// What the bits mean that are set, joined by commas.
std::string describe(std::uint8_t status, std::span<const Trouble> troubles);

}  // namespace usher::serial_frame
