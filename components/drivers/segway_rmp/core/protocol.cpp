#include "drivers/segway_rmp/core/protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "drivers/segway_rmp/core/status.hpp"
#include "foundation/geometry/angle.hpp"

namespace usher::segway_rmp {

namespace {

constexpr double kMostSpeedCounts = 1176.0;
constexpr double kMostTurnCounts = 1024.0;
constexpr double kMostStep = 5.0;  // [m] since the last cycle; more is a reset of the counter

std::uint16_t counts(double value, double most) {
  if (!std::isfinite(value)) return 0;
  const auto rounded = static_cast<std::int16_t>(std::lround(std::clamp(value, -most, most)));
  return static_cast<std::uint16_t>(rounded);
}

/// The difference of two counters that wrap.
std::int32_t difference(std::int32_t later, std::int32_t earlier) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(later) -
                                   static_cast<std::uint32_t>(earlier));
}

}  // namespace

PacketBytes command(const geometry::Twist2& twist, const Calibration& calibration, Setting setting,
                    std::uint16_t value) {
  // Half a command is no command.
  const geometry::Twist2 sound = twist.finite() ? twist : geometry::Twist2{};
  return to_base(
      kIdCommand,
      {counts(sound.v * calibration.command_counts_per_speed, kMostSpeedCounts),
       counts(sound.w * calibration.command_counts_per_turn_rate * calibration.command_turn_sign,
              kMostTurnCounts),
       static_cast<std::uint16_t>(setting), value});
}

PacketBytes shutdown() { return to_base(kIdShutdown, {0, 0, 0, 0}); }

void FeedbackAssembler::reopened() {
  FeedbackAssembler anew(calibration_);
  anew.feedback_.left_travel = feedback_.left_travel;
  anew.feedback_.right_travel = feedback_.right_travel;
  anew.counters_known_ = counters_known_;
  anew.left_counter_ = left_counter_;
  anew.right_counter_ = right_counter_;
  anew.incomplete_cycles_ = incomplete_cycles_;
  anew.counter_jumps_ = counter_jumps_;
  *this = anew;
}

Mode FeedbackAssembler::mode() const {
  if (status_at_) {
    const StatusReport status = report(feedback_.status_1, feedback_.status_2);
    if (status.emergency_stop_open) return Mode::kEmergency;
    return status.balancing ? Mode::kBalancing : Mode::kStandby;
  }
  return operational_mode_ == kModeBalance ? Mode::kBalancing : Mode::kStandby;
}

void FeedbackAssembler::travel(const Packet& packet) {
  const std::int32_t left = packet.counter(0);
  const std::int32_t right = packet.counter(2);
  if (counters_known_) {
    const double left_step = difference(left, left_counter_) / calibration_.counts_per_meter;
    const double right_step = difference(right, right_counter_) / calibration_.counts_per_meter;
    if (std::abs(left_step) > kMostStep || std::abs(right_step) > kMostStep) {
      ++counter_jumps_;
    } else {
      feedback_.left_travel += left_step;
      feedback_.right_travel += right_step;
    }
  }
  if (!counters_known_) {
    feedback_.left_travel = left / calibration_.counts_per_meter;
    feedback_.right_travel = right / calibration_.counts_per_meter;
  }
  counters_known_ = true;
  left_counter_ = left;
  right_counter_ = right;
}

std::optional<SegwayFeedback> FeedbackAssembler::take(const Packet& packet, Time now) {
  if (!channel_b_) channel_b_ = packet.channel_b;
  if (packet.channel_b != *channel_b_) {
    if (++of_other_channel_ < kOtherChannelTakesOver) return std::nullopt;
    channel_b_ = packet.channel_b;
    has_ = 0;
    status_at_.reset();
    mode_at_.reset();
  }
  of_other_channel_ = 0;

  const double rate = geometry::radians(1.0 / calibration_.counts_per_degree);
  switch (packet.id) {
    case kIdPitch:
      feedback_.pitch = packet.signed_slot(0) * rate;
      feedback_.pitch_rate = packet.signed_slot(1) * rate;
      feedback_.roll = packet.signed_slot(2) * rate;
      feedback_.roll_rate = packet.signed_slot(3) * rate;
      has_ |= kHasPitch;
      break;
    case kIdVelocity:
      feedback_.left_velocity = packet.signed_slot(0) / calibration_.counts_per_speed;
      feedback_.right_velocity = packet.signed_slot(1) / calibration_.counts_per_speed;
      feedback_.yaw_rate = packet.signed_slot(2) * rate;
      has_ |= kHasVelocity;
      break;
    case kIdWheels:
      travel(packet);
      has_ |= kHasWheels;
      break;
    case kIdTorque:
      feedback_.left_torque = packet.signed_slot(0) / calibration_.counts_per_torque;
      feedback_.right_torque = packet.signed_slot(1) / calibration_.counts_per_torque;
      break;
    case kIdMode: {
      operational_mode_ = packet.slots[0];
      mode_at_ = now;
      const double volts = packet.slots[3] / 4.0;
      const double range = calibration_.battery_full - calibration_.battery_empty;
      feedback_.battery_percent =
          std::clamp(100.0 * (volts - calibration_.battery_empty) / range, 0.0, 100.0);
      break;
    }
    case kIdStatus:
      feedback_.status_1 = packet.slots[1];
      feedback_.status_2 = packet.slots[2];
      status_at_ = now;
      break;
    case kIdEcho: {
      const bool whole = has_ == kHasAll && mode_known(now);
      has_ = 0;
      if (!whole) {
        ++incomplete_cycles_;
        return std::nullopt;
      }
      feedback_.stamp = now;
      feedback_.mode = mode();
      return feedback_;
    }
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace usher::segway_rmp
