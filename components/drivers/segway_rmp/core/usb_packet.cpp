#include "drivers/segway_rmp/core/usb_packet.hpp"

#include <algorithm>

namespace usher::segway_rmp {

namespace {

constexpr std::uint8_t kFirst = 0xF0;
constexpr std::uint8_t kSecond = 0x55;
constexpr std::uint8_t kChannelA = 0xAA;
constexpr std::uint8_t kChannelB = 0xBB;
constexpr std::size_t kData = 9;  // first of the eight CAN bytes

void put_slots(PacketBytes& bytes, const std::array<std::uint16_t, 4>& slots) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    bytes[kData + 2 * i] = static_cast<std::uint8_t>(slots[i] >> 8);
    bytes[kData + 2 * i + 1] = static_cast<std::uint8_t>(slots[i]);
  }
  bytes[kPacketSize - 1] = checksum(std::span(bytes).first<kPacketSize - 1>());
}

}  // namespace

std::uint8_t checksum(std::span<const std::uint8_t, kPacketSize - 1> bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  sum = (sum & 0xFF) + (sum >> 8);
  sum = (sum & 0xFF) + (sum >> 8);
  return static_cast<std::uint8_t>(0U - sum);
}

PacketBytes to_base(std::uint16_t id, const std::array<std::uint16_t, 4>& slots) {
  PacketBytes bytes{kFirst, kSecond};
  bytes[6] = static_cast<std::uint8_t>(id >> 8);
  bytes[7] = static_cast<std::uint8_t>(id);
  put_slots(bytes, slots);
  return bytes;
}

PacketBytes from_base(const Packet& packet) {
  PacketBytes bytes{kFirst, kSecond, packet.channel_b ? kChannelB : kChannelA};
  bytes[4] = static_cast<std::uint8_t>(packet.id >> 3);
  bytes[5] = static_cast<std::uint8_t>(packet.id << 5);
  put_slots(bytes, packet.slots);
  return bytes;
}

bool PacketDecoder::could_begin() const {
  return (filled_ < 1 || buffer_[0] == kFirst) && (filled_ < 2 || buffer_[1] == kSecond) &&
         (filled_ < 3 || buffer_[2] == kChannelA || buffer_[2] == kChannelB);
}

void PacketDecoder::drop_first() {
  do {
    std::copy(buffer_.begin() + 1, buffer_.begin() + static_cast<std::ptrdiff_t>(filled_),
              buffer_.begin());
    --filled_;
    ++skipped_bytes_;
  } while (filled_ > 0 && !could_begin());
}

std::optional<Packet> PacketDecoder::take(std::uint8_t byte) {
  buffer_[filled_++] = byte;
  if (!could_begin()) drop_first();
  if (filled_ < kPacketSize) return std::nullopt;
  if (checksum(std::span(buffer_).first<kPacketSize - 1>()) != buffer_[kPacketSize - 1]) {
    ++bad_checksums_;
    drop_first();
    return std::nullopt;
  }
  filled_ = 0;
  Packet packet;
  packet.channel_b = buffer_[2] == kChannelB;
  packet.id = static_cast<std::uint16_t>(((buffer_[4] << 3) | (buffer_[5] >> 5)) & 0xFFF);
  for (std::size_t i = 0; i < packet.slots.size(); ++i) {
    packet.slots[i] =
        static_cast<std::uint16_t>((buffer_[kData + 2 * i] << 8) | buffer_[kData + 2 * i + 1]);
  }
  return packet;
}

}  // namespace usher::segway_rmp
