#pragma once

#include <cstdint>
#include <string>

namespace usher::segway_rmp {

/// Bits of the first status word (frame 0680).
enum : std::uint16_t {
  kSafetyShutdown1 = 0x0001,
  kSafetyShutdown2 = 0x0004,
  kDisableResponse = 0x0008,
  kSpeedLimit4Mph = 0x0010,  // 1.8 m/s: no robot of ours is as fast
  kSpeedLimit0Mph = 0x0020,
  kSystemIntegrity = 0x0040,
  kMotorsEnabled = 0x0080,
  kBalanceMode = 0x0100,
  kYawTransient = 0x0200,
  kEmptyBatteryHazard = 0x0400,
  kWheelSlip = 0x1000,
  kMotorFeedback = 0x2000,
  kLowBatteryHazard = 0x4000,
};

/// Bits of either side in the second status word: side A in its low byte, side B in its high byte.
enum : std::uint8_t {
  kPitchLimit = 0x01,
  kEmergencyStopOpen = 0x02,
  kPositionError = 0x04,
  kMaxVelocityExceeded = 0x08,
  kBatteryEmpty = 0x10,
  kBatteryTemperature = 0x20,
  kRollLimit = 0x40,
  kLowBusVoltage = 0x80,
};

enum class Severity : std::uint8_t { kOk, kWarning, kError };

/// What the status words mean for an operator.
struct StatusReport {
  Severity severity = Severity::kOk;
  bool motors_enabled = false;
  bool balancing = false;
  bool emergency_stop_open = false;
  std::string text;  ///< every bit that is not as it should be; empty when all is well
};

StatusReport report(std::uint16_t word_1, std::uint16_t word_2);

}  // namespace usher::segway_rmp
