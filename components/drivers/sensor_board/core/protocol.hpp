#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "drivers/sensor_board/core/device.hpp"
#include "drivers/serial_frame/core/frame.hpp"

namespace usher::sensor_board {

using serial_frame::crc16;
using serial_frame::encode;
using serial_frame::Frame;
using serial_frame::FrameDecoder;
using serial_frame::kLongestContent;

/// Bits of the board's status.
enum : std::uint8_t {
  kWatchdogExpired = 0x01,  ///< the host was silent, the servo holds
  kServoOff = 0x02,
  kSupplyLow = 0x04,
  kSonarBusFault = 0x08,
  kRebooted = 0x80,  ///< since its last Hello
};

/// At boot and on request.
struct Hello {
  std::uint8_t protocol_version = 0;
  std::array<std::uint8_t, 3> firmware{};  ///< major, minor, patch
  std::uint32_t serial_number = 0;
  std::uint8_t sonars = 0;
  std::uint8_t whiskers = 0;
};

/// 20 Hz.
struct Sensors {
  std::uint32_t time_ms = 0;                       ///< of the board, since its start
  std::array<std::uint16_t, kSonars> ranges_mm{};  ///< 0 sensor fault, FFFF no echo
  std::uint8_t whisker_mask = 0;                   ///< a bit per switch, 1 is pressed
  std::int16_t tilt = 0;                           ///< [0.1 deg]
  std::uint8_t status = 0;
};

/// At once when a switch changes.
struct WhiskerChange {
  std::uint32_t time_ms = 0;
  std::uint8_t mask = 0;
  std::uint8_t changed = 0;
};

/// The board's verdict on a command.
struct Verdict {
  bool accepted = false;
  std::uint8_t type = 0;
  std::uint8_t sequence = 0;
  std::uint8_t reason = 0;  ///< 0 none, 1 unknown, 2 range, 3 busy
};

struct BoardMessage {
  std::uint8_t sequence = 0;
  std::variant<Hello, Sensors, WhiskerChange, Verdict> content;
};

/// Nothing when the type is unknown or the length is not the type's.
std::optional<BoardMessage> parse(std::span<const std::uint8_t> content);

// Frames to the board.
Frame hello_request(std::uint8_t sequence);
Frame heartbeat(std::uint8_t sequence);
/// [0.1 deg]; the board clips it to its limits.
Frame set_tilt(std::uint8_t sequence, std::int16_t tilt);
Frame set_config(std::uint8_t sequence, std::uint8_t key, std::int32_t value);

// Frames of the board; for emulators.
Frame to_frame(const BoardMessage& message);

}  // namespace usher::sensor_board
