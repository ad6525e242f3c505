#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace usher::p3dx {

/// Numbers of client commands (ARCOS).
enum class Command : std::uint8_t {
  kPulse = 0,
  kOpen = 1,
  kClose = 2,
  kEnable = 4,
  kSetAcceleration = 5,  ///< [mm/s^2]
  kSetMaxVelocity = 6,   ///< [mm/s]
  kSetOrigin = 7,
  kSetMaxTurnRate = 10,       ///< [deg/s]
  kVelocity = 11,             ///< [mm/s]
  kTurnRate = 21,             ///< [deg/s]
  kSetTurnAcceleration = 23,  ///< [deg/s^2]
  kSonar = 28,
  kEmergencyStop = 55,
};

/// FA FB, the count of what follows, and at most 200 bytes of it, checksum included.
inline constexpr std::size_t kMaxCount = 200;

/// Over everything between count and checksum: big-endian pairs added, an odd last byte
/// exclusive-ored into the low byte.
std::uint16_t checksum(std::span<const std::uint8_t> bytes);

/// One client packet.
struct Frame {
  std::array<std::uint8_t, 9> bytes{};
  std::size_t size = 0;
  std::span<const std::uint8_t> span() const { return {bytes.data(), size}; }
};
/// A command without an argument: also SYNC0, SYNC1 and SYNC2, which share the first three numbers.
Frame encode(Command command);
/// With a number; its sign travels apart from its magnitude, which is cut to 32767.
Frame encode(Command command, int argument);

/// Finds packets in a stream of bytes. A damaged packet costs only itself.
class Decoder {
 public:
  void reset() { size_ = 0; }

  /// Calls `on_packet(std::span<const std::uint8_t>)` with type and data of every packet whose
  /// checksum holds, without the checksum. Configuration packets (type 20 hex) come from real
  /// firmware with a wrong checksum and count as whole.
  template <class OnPacket>
  void feed(std::span<const std::uint8_t> bytes, OnPacket&& on_packet) {
    for (const std::uint8_t byte : bytes) {
      buffer_[size_++] = byte;
      while (find()) {
        on_packet(std::span<const std::uint8_t>(buffer_.data() + 3, count() - 2));
        drop(count() + 3);
      }
    }
  }

  std::uint64_t damaged() const { return damaged_; }  ///< packets with a wrong checksum
  std::uint64_t skipped() const { return skipped_; }  ///< bytes outside packets

 private:
  std::size_t count() const { return buffer_[2]; }
  bool begins() const;
  bool find();
  void drop(std::size_t count);

  std::array<std::uint8_t, kMaxCount + 3> buffer_{};
  std::size_t size_ = 0;
  std::uint64_t damaged_ = 0;
  std::uint64_t skipped_ = 0;
};

}  // namespace usher::p3dx
