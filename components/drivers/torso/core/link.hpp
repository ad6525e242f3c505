#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/serial_frame/core/dialogue.hpp"
#include "drivers/torso/core/protocol.hpp"

namespace usher::torso {

/// The dialogue with the torso's board: tells it where joints and eyes shall be, and turns what it
/// says into readings.
class Link {
 public:
  Link();

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_reading(const Reading&)` for each new reading.
  template <class OnReading>
  void received(std::span<const std::uint8_t> bytes, Time now, OnReading&& on_reading) {
    dialogue_.received(bytes, [&](std::span<const std::uint8_t> content) {
      if (take(content, now)) on_reading(static_cast<const Reading&>(reading_));
    });
  }

  /// What the torso shall show now; told once, and only to a board that was greeted. Ignored when a
  /// joint is not finite.
  void show(const TorsoFrame& frame);

  /// Time passed; call it at 20 Hz or more.
  void tick(Time now);

  /// What is to be sent; empties it.
  std::vector<std::uint8_t> take_output() { return dialogue_.take_output(); }

  /// The board says where it is, as it should.
  bool healthy(Time now) const { return dialogue_.healthy(now); }
  /// Why it is not well; empty when it is.
  std::string reason(Time now) const;

  const serial_frame::Dialogue& dialogue() const { return dialogue_; }

 private:
  bool take(std::span<const std::uint8_t> content, Time now);

  serial_frame::Dialogue dialogue_;
  std::optional<TorsoFrame> due_;
  Reading reading_;
};

}  // namespace usher::torso
