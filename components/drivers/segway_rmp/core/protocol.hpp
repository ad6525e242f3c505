#pragma once

#include <cstdint>
#include <optional>

#include "drivers/segway_rmp/core/device.hpp"
#include "drivers/segway_rmp/core/usb_packet.hpp"
#include "foundation/geometry/pose2.hpp"

namespace usher::segway_rmp {

/// Counts per unit of an RMP200. What the sources disagree about, all of it in commands, is to be
/// calibrated on the robot.
struct Calibration {
  double command_counts_per_speed = 147.0 / 0.44704;  ///< [1/(m/s)] 147 per mph; others: 332
  double command_counts_per_turn_rate = 447.0;        ///< [1/(rad/s)] sources: 326, 333, 447
  double command_turn_sign = 1.0;                     ///< {1, -1} positive turns left
  double counts_per_speed = 332.0;                    ///< [1/(m/s)] of the feedback
  double counts_per_degree = 7.8;                     ///< angles and rates
  double counts_per_meter = 33215.0;
  double counts_per_torque = 1094.0;  ///< [1/Nm]
  double battery_empty = 66.0;        ///< [V]
  double battery_full = 78.0;         ///< [V]
};

/// What can be configured with a command frame.
enum class Setting : std::uint16_t {
  kNone = 0,
  kMaxVelocityScale = 10,      ///< {0..16} 16 is all
  kMaxAccelerationScale = 11,  ///< {0..16}
  kMaxTurnScale = 12,          ///< {0..16}
  kGainSchedule = 13,          ///< 0 light, 1 tall, 2 heavy
  kCurrentLimit = 14,          ///< {0..256}
  kBalanceLockout = 15,        ///< 1 locks the balance mode
  kOperationalMode = 16,       ///< 0 disable, 1 tractor, 2 balance, 3 power down
  kResetIntegrators = 50,      ///< bits: right, left, yaw, fore/aft
};
inline constexpr std::uint16_t kModeDisabled = 0;
inline constexpr std::uint16_t kModeTractor = 1;
inline constexpr std::uint16_t kModeBalance = 2;

/// A command frame: motion, and one setting at the most. What is not finite is zero; the rest is
/// clipped to what the base understands.
PacketBytes command(const geometry::Twist2& twist, const Calibration& calibration,
                    Setting setting = Setting::kNone, std::uint16_t value = 0);

/// Motors off at once: a balancing base falls on its limiters.
PacketBytes shutdown();

/// Collects the frames of a control cycle.
class FeedbackAssembler {
 public:
  explicit FeedbackAssembler(const Calibration& calibration) : calibration_(calibration) {}

  /// A packet arrived at `now`. The feedback, when it completes a cycle in which pitch, velocities
  /// and wheels were all heard, and the base has said within kModeAge whether it balances: by its
  /// status, or by its mode where it never told a status since its line was opened. One of the two
  /// channels is followed; the other one takes over when this one falls silent.
  std::optional<SegwayFeedback> take(const Packet& packet, Time now);

  /// The connection was opened anew: the counters have counted on, nothing else is known.
  void reopened();

  /// The operational mode that the base reports, if it was heard.
  std::optional<std::uint16_t> operational_mode() const { return operational_mode_; }
  /// Both are told in every cycle of 10 ms.
  static constexpr Time kModeAge = std::chrono::milliseconds(100);
  std::uint64_t incomplete_cycles() const { return incomplete_cycles_; }
  std::uint64_t counter_jumps() const { return counter_jumps_; }  ///< resets of the odometers

 private:
  enum : unsigned { kHasPitch = 1, kHasVelocity = 2, kHasWheels = 4, kHasAll = 7 };
  static constexpr int kOtherChannelTakesOver = 16;  ///< packets in a row, two cycles

  void travel(const Packet& packet);
  Mode mode() const;
  bool mode_known(Time now) const {
    const auto& told_at = status_at_ ? status_at_ : mode_at_;
    return told_at && now - *told_at < kModeAge;
  }

  Calibration calibration_;
  SegwayFeedback feedback_;
  unsigned has_ = 0;
  std::optional<bool> channel_b_;
  int of_other_channel_ = 0;
  bool counters_known_ = false;
  std::int32_t left_counter_ = 0;
  std::int32_t right_counter_ = 0;
  std::optional<Time> status_at_, mode_at_;  ///< when they were last heard
  std::optional<std::uint16_t> operational_mode_;
  std::uint64_t incomplete_cycles_ = 0;
  std::uint64_t counter_jumps_ = 0;
};

}  // namespace usher::segway_rmp
