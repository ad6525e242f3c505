#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/segway_rmp/core/protocol.hpp"

namespace usher::segway_rmp {

/// The dialogue with one base over its USB line: configure, command in every cycle, watch.
///
/// The base answers nothing and holds the last command for 0.4 s, so settings are sent repeatedly
/// and a command frame goes out in every cycle, zero where nothing else is wanted.
///
/// A base that balanced and then reports its motors off has fallen, or somebody switched it off: it
/// counts as an emergency stop, so that it does not get up by itself while it is lifted. So does
/// one that went off while its line was closed, or while no driver ran: until it says how it is, it
/// is told nothing but zero.
class Link {
 public:
  struct Parameters {
    Calibration calibration;
    std::uint16_t velocity_scale = 16;             ///< {0..16}
    std::uint16_t acceleration_scale = 8;          ///< {0..16}
    std::uint16_t turn_scale = 16;                 ///< {0..16}
    std::uint16_t gain_schedule = 1;               ///< tall
    Time settle = std::chrono::milliseconds(250);  ///< after opening the line holds old bytes
    Time lost = std::chrono::seconds(1);           ///< without feedback the base is disconnected
  };

  Link();
  explicit Link(const Parameters& parameters);

  void opened(Time now);
  void closed();

  /// Bytes arrived; calls `on_feedback(const SegwayFeedback&)` for each whole cycle.
  template <class OnFeedback>
  void received(std::span<const std::uint8_t> bytes, Time now, OnFeedback&& on_feedback) {
    if (!open_ || now - opened_at_ < parameters_.settle) return;
    decoder_.feed(bytes, [&](const Packet& packet) {
      if (const auto feedback = take(packet, now)) on_feedback(*feedback);
    });
  }

  /// The frames to send in this cycle (50 Hz or more), valid until the next call; empty while the
  /// line is closed. Nothing drives while the base is being configured or in emergency.
  std::span<const std::uint8_t> cycle(const geometry::Twist2& wanted, Time now);

  /// The frame that commands this and sets nothing.
  PacketBytes velocity(const geometry::Twist2& twist) const {
    return command(twist, parameters_.calibration);
  }

  /// An earlier driver saw it balance, and nobody has told it to balance anew since.
  void balanced_before() { balanced_ = true; }
  /// Motors off until reset().
  void emergency_stop() { emergency_ = true; }
  /// An operator asks to balance again: configures the base anew. No effect on one that is neither
  /// off nor in emergency.
  void reset();

  /// The settings were all sent.
  bool configured() const { return step_ >= kSteps * kRepeats; }
  bool emergency() const { return emergency_; }
  /// It balanced since it was last told to; whether it still does, tells mode().
  bool balanced() const { return balanced_; }
  /// The next cycle says nothing that a later one would not say again: only the newest counts.
  bool velocity_only() const { return emergency_ || configured() || asks_first(); }
  Mode mode(Time now) const;
  /// Why it does not drive, or a warning; empty when all is well.
  const std::string& reason() const { return reason_; }

  const PacketDecoder& decoder() const { return decoder_; }
  const FeedbackAssembler& assembler() const { return assembler_; }

 private:
  static constexpr int kSteps = 6;
  static constexpr int kRepeats = 3;

  std::optional<SegwayFeedback> take(const Packet& packet, Time now);
  /// It balanced before the line was opened; whether it still does is not known.
  bool asks_first() const { return balanced_ && !feedback_at_; }

  Parameters parameters_;
  PacketDecoder decoder_;
  FeedbackAssembler assembler_;
  bool open_ = false;
  Time opened_at_{};
  int step_ = 0;
  bool emergency_ = false;
  bool balanced_ = false;  ///< it did since it was last told to
  bool off_ = false;       ///< its motors are, by its last feedback
  std::optional<Time> feedback_at_;
  Mode reported_ = Mode::kDisconnected;
  std::uint16_t status_1_ = 0;
  std::uint16_t status_2_ = 0;
  std::string reason_ = "not connected";
  PacketBytes output_{};
};

}  // namespace usher::segway_rmp
