#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/serial_frame/core/frame.hpp"
#include "drivers/torso/core/device.hpp"

namespace usher::torso {

/// Bits of the board's status beside those that all boards share.
enum : std::uint8_t {
  kServosOff = 0x02,
  kSupplyLow = 0x04,
  kJointStuck = 0x08,  ///< a joint does not get where it shall
};

/// 20 Hz.
struct State {
  std::uint32_t time_ms = 0;  ///< of the board, since its start
  TorsoFrame frame;           ///< in steps of 0.01 deg, 0.1 mm and 1/255
  std::uint8_t status = 0;
};

struct BoardMessage {
  std::uint8_t sequence = 0;
  State state;
};

/// Nothing when the type is unknown, the length is not the type's, or a joint stands where none can
/// (beyond half a turn or 1 m).
std::optional<BoardMessage> parse(std::span<const std::uint8_t> content);

/// What the board was told; for emulators and tests. Nothing when it is no frame for the torso.
std::optional<TorsoFrame> parse_command(std::span<const std::uint8_t> content);

/// To the board. `frame` is finite; a joint beyond half a turn or 1 m is clipped to that.
serial_frame::Frame set_frame(std::uint8_t sequence, const TorsoFrame& frame);

/// Of the board; for emulators.
serial_frame::Frame to_frame(const BoardMessage& message);

}  // namespace usher::torso
