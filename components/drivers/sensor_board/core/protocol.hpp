#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "drivers/sensor_board/core/device.hpp"
#include "drivers/serial_frame/core/frame.hpp"

namespace usher::sensor_board {

using serial_frame::Frame;

/// Bits of the board's status beside those that all boards share.
enum : std::uint8_t {
  kServoOff = 0x02,
  kSupplyLow = 0x04,
  kSonarBusFault = 0x08,
};

/// 20 Hz.
struct Sensors {
  std::uint32_t time_ms = 0;                       ///< of the board, since its start
  std::array<std::uint16_t, kSonars> ranges_mm{};  ///< 0 sensor fault, FFFF no echo
  std::uint8_t whisker_mask = 0;                   ///< a bit per switch, 1 is pressed
  std::int16_t tilt = 0;                           ///< [0.1 deg] where the servo stands
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
  std::variant<Sensors, WhiskerChange, Verdict> content;
};

/// Nothing when the type is unknown or the length is not the type's.
std::optional<BoardMessage> parse(std::span<const std::uint8_t> content);

// Frames to the board.
/// [0.1 deg] where the servo shall go; the board clips it to its limits.
Frame set_tilt(std::uint8_t sequence, std::int16_t tilt);
Frame set_config(std::uint8_t sequence, std::uint8_t key, std::int32_t value);

// Frames of the board; for emulators.
Frame to_frame(const BoardMessage& message);

}  // namespace usher::sensor_board
