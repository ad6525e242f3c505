#include "drivers/segway_rmp/core/emulated_base.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/segway_rmp/core/status.hpp"
#include "foundation/geometry/angle.hpp"

namespace usher::segway_rmp {

namespace {

constexpr std::size_t kId = 6;
constexpr std::size_t kSlots = 9;
constexpr std::uint16_t kEmulatedBuild = 0x027A;

std::uint16_t counts(double value) {
  const double rounded = std::round(std::clamp(value, -32768.0, 32767.0));
  return static_cast<std::uint16_t>(static_cast<std::int16_t>(rounded));
}

/// A counter of 32 bits that wraps.
std::uint32_t counter(double value) {
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::llround(value)));
}

std::uint16_t low(std::uint32_t value) { return static_cast<std::uint16_t>(value & 0xFFFF); }
std::uint16_t high(std::uint32_t value) { return static_cast<std::uint16_t>(value >> 16); }

}  // namespace

bool EmulatedBase::take(std::uint8_t byte) {
  frame_[filled_++] = byte;
  if ((filled_ == 1 && byte != 0xF0) || (filled_ == 2 && byte != 0x55)) {
    filled_ = byte == 0xF0 ? 1 : 0;
    frame_[0] = byte;
    ++skipped_bytes_;
    return false;
  }
  if (filled_ < kPacketSize) return false;
  filled_ = 0;
  const bool whole =
      checksum(std::span(frame_).first<kPacketSize - 1>()) == frame_[kPacketSize - 1];
  if (!whole) skipped_bytes_ += kPacketSize;
  return whole;
}

std::uint16_t EmulatedBase::word(std::size_t at) const {
  return static_cast<std::uint16_t>((frame_[at] << 8) | frame_[at + 1]);
}

EmulatedBase::Wish EmulatedBase::wish_of_frame() const {
  if (word(kId) == kIdShutdown) return Wish::kShutdown;
  const bool balance = word(kSlots + 4) == static_cast<std::uint16_t>(Setting::kOperationalMode) &&
                       word(kSlots + 6) == kModeBalance;
  return word(kId) == kIdCommand && balance ? Wish::kBalance : Wish::kDrive;
}

geometry::Twist2 EmulatedBase::twist_of_frame() const {
  if (word(kId) != kIdCommand) return {};
  const auto value = [this](std::size_t at) {
    return static_cast<double>(static_cast<std::int16_t>(word(at)));
  };
  return {value(kSlots) / calibration_.command_counts_per_speed,
          value(kSlots + 2) /
              (calibration_.command_counts_per_turn_rate * calibration_.command_turn_sign)};
}

std::span<const std::uint8_t> EmulatedBase::feedback(const SegwayFeedback& state) {
  const double per_radian = geometry::degrees(1.0) * calibration_.counts_per_degree;
  const auto angle = [&](double radians) { return counts(radians * per_radian); };
  const auto speed = [&](double v) { return counts(v * calibration_.counts_per_speed); };
  const std::uint32_t left = counter(state.left_travel * calibration_.counts_per_meter);
  const std::uint32_t right = counter(state.right_travel * calibration_.counts_per_meter);
  const bool on = state.mode == Mode::kBalancing;
  const double charge = std::isfinite(state.battery_percent) ? state.battery_percent / 100.0 : 0.0;
  const double volts = calibration_.battery_empty +
                       charge * (calibration_.battery_full - calibration_.battery_empty);
  const auto status =
      static_cast<std::uint16_t>(state.status_1 | (on ? kMotorsEnabled | kBalanceMode : 0));
  std::size_t at = 0;
  for (const bool channel_b : {false, true}) {
    const std::array<Packet, kFrames> packets{{
        {channel_b,
         kIdPitch,
         {angle(state.pitch), angle(state.pitch_rate), angle(state.roll), angle(state.roll_rate)}},
        {channel_b,
         kIdVelocity,
         {speed(state.left_velocity), speed(state.right_velocity), angle(state.yaw_rate), 0}},
        {channel_b, kIdWheels, {low(left), high(left), low(right), high(right)}},
        {channel_b,
         kIdTorque,
         {counts(state.left_torque * calibration_.counts_per_torque),
          counts(state.right_torque * calibration_.counts_per_torque), 0, 0}},
        {channel_b,
         kIdMode,
         {on ? kModeBalance : kModeDisabled, 1, kEmulatedBuild, counts(volts * 4.0)}},
        {channel_b, kIdStatus, {0, status, 0, 0}},
        {channel_b, kIdEcho, {0, 0, 0, 0}},
    }};
    for (const Packet& packet : packets) {
      const PacketBytes bytes = from_base(packet);
      std::copy(bytes.begin(), bytes.end(), output_.begin() + static_cast<std::ptrdiff_t>(at));
      at += bytes.size();
    }
  }
  return output_;
}

}  // namespace usher::segway_rmp
