#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/guard/outbox.hpp"

namespace usher::runtime {

/// What a guard process sends to the port that it owns: everything that the driver writes, and the
/// safe bytes instead when the driver is gone or has written nothing for `silence`.
///
/// A driver that was silent is passed on again from its next write on: what it writes then was
/// decided then. The first words to a port that was just opened are safe ones, since this guard may
/// take the place of one that ended while the device moved; after them nothing is sent before the
/// driver's first write: the device may not be ready for it. Bytes that wait because the port is
/// slow are dropped for the safe ones, but never a part of what is already on its way.
///
/// A driver may leave a will: what a device that still moves shall hear instead of the safe bytes
/// for a while. After that the guard of one that ended says farewell; at once where the next one
/// waits for the port.
///
/// Fixed memory, no allocation after the constructor, no clock of its own.
class Guard {
 public:
  using Time = std::chrono::nanoseconds;
  static constexpr int kRepeats = 3;  ///< safe messages in the time of one silence
  static constexpr auto kFarewellEvery = std::chrono::milliseconds(10);
  static constexpr int kFarewells = 3;  ///< safe messages to the port after the driver's end

  /// Safe messages to a port that was just opened: the device may take the first one for the rest
  /// of what an earlier guard left half sent.
  static constexpr int kGreetings = 2;
  static constexpr std::size_t kMostWillBytes = 256;
  static constexpr auto kLongestWill = std::chrono::seconds(1);

  Guard(std::vector<std::uint8_t> safe, Time silence);

  /// The port was opened, and nothing was heard yet.
  void greet();
  /// The driver wrote one message. False when the port is so slow that 64 kB, or 1024
  /// messages, wait for it.
  bool heard(Outbox::Kind kind, std::span<const std::uint8_t> message, Time now);
  /// What to send for so long, kLongestWill at most, from when the driver is found silent or ended;
  /// the newest counts, an empty one is none, one of more than kMostWillBytes is none either. No
  /// sign of life.
  void will(std::span<const std::uint8_t> message, Time lasts);
  /// The driver ended.
  void gone(Time now);
  /// Another guard wants the port: of a driver that ended the will is void.
  void port_wanted(Time now);
  /// Puts a safe message up when one is due.
  void tick(Time now);

  /// What the port shall get next; empty when nothing waits.
  std::span<const std::uint8_t> output() const { return outbox_.waiting(); }
  /// The port took so many bytes of it.
  void sent(std::size_t count) { outbox_.sent(count); }

  /// When tick() has something to do; nothing while the driver was never heard.
  std::optional<Time> due() const;
  /// The driver is gone and the port was told so: the guard may end.
  bool finished() const { return gone_ && farewells_ == 0 && outbox_.empty(); }
  /// When that begins, of a driver that is gone.
  Time farewell_at() const { return farewell_at_; }
  /// The driver is being overruled.
  bool overruling() const { return overruling_; }

 private:
  void overrule(Time now);
  bool will_counts(Time now) const;
  bool says_farewell(Time now) const { return gone_ && now >= farewell_at_; }

  const std::vector<std::uint8_t> safe_;
  const Time silence_;
  const Time repeat_;  ///< between two safe messages to a silent driver's port
  Outbox outbox_;
  std::optional<Time> heard_at_;
  Time safe_at_{};
  std::vector<std::uint8_t> will_;
  Time will_lasts_{};
  std::optional<Time> silent_since_;  ///< while a driver is overruled
  bool overruling_ = false;
  bool gone_ = false;
  Time farewell_at_{};
  int farewells_ = 0;
};

}  // namespace usher::runtime
