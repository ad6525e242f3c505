#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/base_obedience/core/writer_id.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::drive {

/// Time on the local monotonic clock, never compared with another host's.
using Time = std::chrono::nanoseconds;

/// The right to drive, as heard on drive/grant.
struct Grant {
  WriterId writer = kNobody;   ///< who may drive; kNobody withdraws the right at once
  std::uint64_t epoch = 0;     ///< grows with every new decision of the supervisor, never shrinks
  WriterId grantor = kNobody;  ///< the writer of the grant itself
  Time age{};                  ///< {>= 0} since it was written, as far as this host can tell
  Time valid_for = std::chrono::milliseconds(120);  ///< {>= 0} wish of the grantor; the limit holds
  bool operator==(const Grant&) const = default;
};

/// An epoch so far above the highest that was heard is nonsense: no supervisor decides so often,
/// and above it the next one must still be heard.
inline constexpr std::uint64_t kLongestLeap = std::uint64_t{1} << 32;

/// A velocity command, as heard on drive/command.
struct Command {
  WriterId writer = kNobody;   ///< who wrote it, from the middleware, not from the message
  std::uint64_t epoch = 0;     ///< the epoch of the grant that the writer believes to hold
  std::uint64_t sequence = 0;  ///< grows with every command of one writer
  geometry::Twist2 twist;
  Time age{};  ///< {>= 0} since it was written, as far as this host can tell
};

/// Why the base drives, or why it does not.
enum class Reason : std::uint8_t {
  kObeyed,              ///< the granted writer's command is driven
  kNoGrant,             ///< no grant was ever heard, or the supervisor withdrew it
  kGrantExpired,        ///< the supervisor fell silent
  kTwoGrantors,         ///< two live writers grant the right to drive
  kNoCommand,           ///< granted, but nothing was commanded under this grant yet
  kCommandExpired,      ///< the granted writer fell silent
  kForeignWriter,       ///< a command of somebody without the grant (it changes nothing)
  kWrongEpoch,          ///< a command for an older or newer grant
  kSequenceNotGrowing,  ///< a repeated or late command
  kNotFinite,           ///< NaN or infinity
  kBeyondLimits,        ///< faster than this base may ever be commanded
};
inline constexpr std::size_t kReasonCount = 11;

/// One sentence for an operator.
std::string_view text(Reason reason);

/// What to send to the base now, and why.
struct Decision {
  geometry::Twist2 twist;  ///< zero unless the granted writer's newest command may be driven
  Reason reason = Reason::kNoGrant;
};

/// Decides what a base driver may drive: only commands of the one granted writer, under a live
/// grant, in growing sequence, with finite values within absolute limits, and only for as long as
/// they are fresh. Anything else is zero.
///
/// - A grant lives for `grant_expiry` from its writing, or shorter where it says so; a command for
///   `command_expiry` from its writing. Late is as good as never.
/// - Epochs only grow: a grant of an older epoch, or of one that leaps by more than `kLongestLeap`,
///   is ignored, and one of the present epoch may only renew or withdraw. After a withdrawal the
///   next grant needs a higher epoch.
/// - While two grantors speak within one expiry, nobody drives.
/// - A faulty command of the granted writer stops the base at once and voids the command before it.
///   A command of anybody else changes nothing and is counted.
///
/// Deterministic, no allocation, constant time. `now` must not go back between calls.
class BaseObedience {
 public:
  struct Limits {
    double linear = 1.5;                                   ///< [m/s] {> 0} absolute
    double angular = 1.5;                                  ///< [rad/s] {> 0} absolute
    Time grant_expiry = std::chrono::milliseconds(120);    ///< {> 0}
    Time command_expiry = std::chrono::milliseconds(120);  ///< {> 0}
  };

  BaseObedience();
  explicit BaseObedience(const Limits& limits);

  /// A grant arrived at `now`.
  void grant(const Grant& grant, Time now);

  /// A command arrived at `now`. The reason is the verdict on this command; the twist is what to
  /// drive now, which for kForeignWriter may be the granted writer's command of before.
  Decision permitted(const Command& command, Time now);

  /// What to drive at `now`; call it in every cycle of the base.
  Decision permitted(Time now) const;

  /// Whether this writer belongs to who grants the right to drive, and that one is heard.
  bool of_grantor(const WriterId& writer, Time now) const;

  /// The highest epoch heard, for the base's status: a supervisor that lost its memory continues
  /// above it.
  std::uint64_t highest_epoch() const { return highest_epoch_; }

  /// How often commands were judged so, by Reason; silence is not counted.
  std::uint64_t count(Reason reason) const { return counts_[static_cast<std::size_t>(reason)]; }

 private:
  struct Heard {
    Time at{};
    geometry::Twist2 twist;
  };

  Reason grant_state(Time now) const;
  Reason judge(const Command& command, Time now) const;

  Limits limits_;
  std::uint64_t highest_epoch_ = 0;
  Time grant_life_{};       ///< of the present grant
  bool withdrawn_ = false;  ///< the present epoch was ended by its grantor
  WriterId holder_ = kNobody;
  std::optional<Time> granted_at_;  ///< writing of the newest renewal
  WriterId grantor_ = kNobody;
  std::optional<Time> grantor_at_;  ///< when the grantor was last heard
  std::optional<Time> dispute_at_;  ///< when a second grantor was last heard
  std::uint64_t last_sequence_ = 0;
  bool sequence_known_ = false;
  std::optional<Heard> command_;  ///< the one to drive
  std::array<std::uint64_t, kReasonCount> counts_{};
};

}  // namespace usher::drive
