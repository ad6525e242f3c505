#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/lms100/core/cola.hpp"
#include "drivers/lms100/core/device.hpp"
#include "foundation/estimation/device_clock.hpp"
#include "foundation/result/result.hpp"

namespace usher::lms100 {

/// One measured quantity of a scan, as sent.
struct Channel {
  std::array<char, 5> content{};  ///< "DIST1", "RSSI1", ...
  float scale = 1.0F;             ///< value * scale + offset is [mm] or digits
  float offset = 0.0F;
  std::int32_t start_angle = 0;    ///< [1e-4 deg] the device's zero is to its right
  std::uint16_t angular_step = 0;  ///< [1e-4 deg]
  std::vector<std::uint16_t> values;

  bool is(std::string_view name) const {
    return std::string_view(content.data(), content.size()) == name;
  }
};

/// An LMDscandata telegram. Reused from scan to scan, so that its vectors keep their memory.
struct ScanTelegram {
  std::uint16_t version = 0;
  std::uint16_t device_number = 0;
  std::uint32_t serial_number = 0;
  std::array<std::uint8_t, 2> status{};  ///< the second: 0 ok, 1 error, 2 pollution, 4/5 its error
  std::uint16_t telegram_counter = 0;
  std::uint16_t scan_counter = 0;
  std::uint32_t scan_time = 0;              ///< [us] of the device since its start; wraps
  std::uint32_t transmission_time = 0;      ///< [us] the same clock
  std::uint32_t scan_frequency = 0;         ///< [0.01 Hz]
  std::uint32_t measurement_frequency = 0;  ///< [100 Hz]
  std::size_t channel_count = 0;
  std::array<Channel, 8> channels;  ///< the first `channel_count` are valid

  const Channel* find(std::string_view content) const;
  bool polluted() const { return status[1] == 2 || status[1] == 4 || status[1] == 5; }
};

/// Reads "sSN LMDscandata" or "sRA LMDscandata". Allocates only while the vectors still grow. On an
/// error the telegram's content is unspecified.
Status read(const Message& message, ScanTelegram& telegram);

/// Turns the distances into a scan in the frame of the device, x straight ahead. Distances below
/// 16 mm are codes: 0 is no echo (+infinity), the others no measurement (NaN) [REP 117].
Status to_scan(const ScanTelegram& telegram, Time stamp, Scan& scan);

/// The LMS100 counts microseconds in 32 bits. After a pause of the host late telegrams are no new
/// start.
inline constexpr estimation::DeviceClock::Counter kCounter{.bits = 32,
                                                           .ticks = 1,
                                                           .last = std::chrono::microseconds(1),
                                                           .restart = std::chrono::seconds(10)};

/// When the scan was measured, on the host's clock: never after its arrival.
Time measured_at(const ScanTelegram& telegram, Time arrival, estimation::DeviceClock& clock);

}  // namespace usher::lms100
