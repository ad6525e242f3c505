#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace usher::p3dx {

/// One sonar reading of a packet.
struct SonarReading {
  std::uint8_t number = 0;
  std::uint16_t range = 0;  ///< [mm]
};

/// The server information packet: what the base says of itself ten times a second. Fields after the
/// digital outputs depend on the firmware and are left out by older ones.
struct Information {
  bool moving = false;
  std::uint16_t x = 0;             ///< [mm] wraps, 15 bits
  std::uint16_t y = 0;             ///< [mm] wraps, 15 bits
  std::int16_t heading = 0;        ///< [2 pi / 4096] wraps
  std::int16_t left_velocity = 0;  ///< [mm/s]
  std::int16_t right_velocity = 0;
  double battery = 0.0;  ///< [V]
  bool left_stall = false;
  bool right_stall = false;
  bool motors_on = false;
  bool stop_button = false;
  bool stall_stop = false;  ///< motors off after a stall, until enabled
  std::array<SonarReading, 32> sonar{};
  std::size_t sonar_count = 0;
  std::optional<double> rotation_rate;  ///< [rad/s]
};

/// Reads type and data of a packet; nothing when it is no such packet or too short for its own
/// counts.
std::optional<Information> parse_information(std::span<const std::uint8_t> packet);

}  // namespace usher::p3dx
