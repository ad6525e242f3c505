#include "drivers/segway_rmp/core/status.hpp"

#include <algorithm>

namespace usher::segway_rmp {

namespace {

struct Meaning {
  std::uint16_t bit;
  Severity severity;
  const char* text;
};

constexpr Meaning kWord1[] = {
    {kSafetyShutdown1, Severity::kError, "safety shutdown 1"},
    {kSafetyShutdown2, Severity::kError, "safety shutdown 2"},
    {kDisableResponse, Severity::kError, "disable response"},
    {kSpeedLimit0Mph, Severity::kWarning, "speed limited to 0 mph"},
    {kSystemIntegrity, Severity::kError, "system integrity fault"},
    {kYawTransient, Severity::kWarning, "yaw transient"},
    {kEmptyBatteryHazard, Severity::kError, "empty battery hazard"},
    {kWheelSlip, Severity::kWarning, "wheel slip"},
    {kMotorFeedback, Severity::kError, "motor feedback fault"},
    {kLowBatteryHazard, Severity::kWarning, "low battery hazard"},
};

constexpr Meaning kWord2[] = {
    {kPitchLimit, Severity::kError, "pitch limit"},
    {kEmergencyStopOpen, Severity::kError, "emergency stop open"},
    {kPositionError, Severity::kError, "wheel position error"},
    {kMaxVelocityExceeded, Severity::kWarning, "maximum velocity exceeded"},
    {kBatteryEmpty, Severity::kError, "battery empty"},
    {kBatteryTemperature, Severity::kWarning, "battery temperature"},
    {kRollLimit, Severity::kError, "roll limit"},
    {kLowBusVoltage, Severity::kWarning, "low bus voltage"},
};

}  // namespace

StatusReport report(std::uint16_t word_1, std::uint16_t word_2) {
  StatusReport result;
  const auto add = [&result](const Meaning& meaning) {
    result.severity = std::max(result.severity, meaning.severity);
    if (!result.text.empty()) result.text += ", ";
    result.text += meaning.text;
  };
  for (const Meaning& meaning : kWord1) {
    if ((word_1 & meaning.bit) != 0) add(meaning);
  }
  const unsigned either_side = (word_2 & 0xFFU) | (static_cast<unsigned>(word_2) >> 8);
  for (const Meaning& meaning : kWord2) {
    if ((either_side & meaning.bit) != 0) add(meaning);
  }
  result.motors_enabled = (word_1 & kMotorsEnabled) != 0;
  result.balancing = result.motors_enabled && (word_1 & kBalanceMode) != 0;
  result.emergency_stop_open = (either_side & kEmergencyStopOpen) != 0;
  return result;
}

}  // namespace usher::segway_rmp
