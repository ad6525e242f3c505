#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/torso/core/protocol.hpp"

namespace usher::torso {

/// The dialogue with the torso's board: says hello, tells it where joints and eyes shall be, keeps
/// its watchdog content while there is nothing to tell, and turns what it says into readings.
class Link {
 public:
  struct Parameters {
    Time boot = std::chrono::seconds(2);  ///< opening the line restarts the board
    Time heartbeat = std::chrono::milliseconds(100);
    Time silence = std::chrono::milliseconds(300);  ///< then nothing is known any more
  };

  Link();
  explicit Link(const Parameters& parameters);

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_reading(const Reading&)` for each new reading.
  template <class OnReading>
  void received(std::span<const std::uint8_t> bytes, Time now, OnReading&& on_reading) {
    if (!open_) return;
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> content) {
      if (take(content, now)) on_reading(static_cast<const Reading&>(reading_));
    });
  }

  /// What the torso shall show now; told once, and only to a board that was greeted. Ignored when a
  /// joint is not finite.
  void show(const TorsoFrame& frame);

  /// Time passed; call it at 20 Hz or more.
  void tick(Time now);

  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output();

  /// The board says where it is, as it should.
  bool healthy(Time now) const;
  /// Why it is not well; empty when it is.
  std::string reason(Time now) const;

  std::uint64_t lost_messages() const { return lost_messages_; }  ///< by the sequence
  std::uint64_t rejected() const { return rejected_; }            ///< whole frames without sense
  std::uint64_t damaged() const { return decoder_.damaged(); }

 private:
  bool take(std::span<const std::uint8_t> content, Time now);
  void take(const Hello& hello);
  void send(const serial_frame::Frame& frame, Time now);

  Parameters parameters_;
  serial_frame::FrameDecoder decoder_;
  bool open_ = false;
  bool greeted_ = false;  ///< the board said hello since the line was opened
  Time opened_at_{};
  std::optional<Time> hello_sent_;
  std::optional<Time> sent_;      ///< the last frame of any kind
  std::optional<Time> heard_at_;  ///< the last State
  std::optional<std::uint8_t> last_sequence_;
  std::uint8_t sequence_ = 0;  ///< of what is sent
  std::optional<TorsoFrame> due_;
  std::uint8_t status_ = 0;
  std::string refusal_;  ///< why the board is not usable at all
  Reading reading_;
  std::vector<std::uint8_t> output_;
  std::uint64_t lost_messages_ = 0;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::torso
