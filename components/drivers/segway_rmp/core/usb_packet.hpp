#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace usher::segway_rmp {

inline constexpr std::size_t kPacketSize = 18;
using PacketBytes = std::array<std::uint8_t, kPacketSize>;

/// One CAN frame inside the base's USB packet.
struct Packet {
  bool channel_b = false;  ///< the base sends everything on two channels
  std::uint16_t id = 0;
  std::array<std::uint16_t, 4> slots{};

  std::int16_t signed_slot(std::size_t i) const { return static_cast<std::int16_t>(slots[i]); }
  /// A counter of 32 bits, low word first.
  std::int32_t counter(std::size_t i) const {
    return static_cast<std::int32_t>((std::uint32_t{slots[i + 1]} << 16) | slots[i]);
  }
  bool operator==(const Packet&) const = default;
};

/// Identifiers.
enum : std::uint16_t {
  kIdShutdown = 0x0412,
  kIdCommand = 0x0413,
  kIdPitch = 0x0401,
  kIdVelocity = 0x0402,
  kIdWheels = 0x0403,
  kIdForward = 0x0404,
  kIdTorque = 0x0405,
  kIdMode = 0x0406,
  kIdEcho = 0x0407,  ///< the last of a cycle
  kIdStatus = 0x0680,
};

/// The sum of the first 17 bytes, folded twice and negated.
std::uint8_t checksum(std::span<const std::uint8_t, kPacketSize - 1> bytes);

/// A packet from the host to the base.
PacketBytes to_base(std::uint16_t id, const std::array<std::uint16_t, 4>& slots);

/// A packet as the base sends it; for emulators.
PacketBytes from_base(const Packet& packet);

/// Finds the base's packets in a byte stream. A damaged packet costs itself and never a whole one
/// behind it. No allocation.
class PacketDecoder {
 public:
  /// Takes bytes, calls `on_packet(const Packet&)` for each whole packet.
  template <class OnPacket>
  void feed(std::span<const std::uint8_t> bytes, OnPacket&& on_packet) {
    for (const std::uint8_t byte : bytes) {
      if (const auto packet = take(byte)) on_packet(*packet);
    }
  }
  void reset() { filled_ = 0; }

  std::uint64_t bad_checksums() const { return bad_checksums_; }
  std::uint64_t skipped_bytes() const { return skipped_bytes_; }

 private:
  std::optional<Packet> take(std::uint8_t byte);
  bool could_begin() const;
  void drop_first();

  PacketBytes buffer_{};
  std::size_t filled_ = 0;
  std::uint64_t bad_checksums_ = 0;
  std::uint64_t skipped_bytes_ = 0;
};

}  // namespace usher::segway_rmp
