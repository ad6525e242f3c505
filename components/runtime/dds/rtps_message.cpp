#include "runtime/dds/rtps_message.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace usher::runtime {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'R', 'T', 'P', 'S'};
constexpr std::size_t kHeader = 20;
constexpr std::size_t kSubmessageHeader = 4;

enum Submessage : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoDestination = 0x0e,
  kData = 0x15,
  kSecureBody = 0x30,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSignedMessagePrefix = 0x33,
  kSignedMessagePostfix = 0x34,
  kStatistics = 0x80,  // of Fast DDS: it ends each message
};
constexpr std::size_t kStatisticsLength = 56;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::uint8_t kInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
constexpr std::uint8_t kHasKey = 0x08;

using EntityId = std::array<std::uint8_t, 4>;
/// A builtin writer that speaks before there are keys, with the reader it speaks to.
struct ClearChannel {
  EntityId writer, reader;
};
constexpr ClearChannel kAnnouncements{{0x00, 0x01, 0x00, 0xc2}, {0x00, 0x01, 0x00, 0xc7}};
constexpr ClearChannel kAuthentication{{0x00, 0x02, 0x01, 0xc3}, {0x00, 0x02, 0x01, 0xc4}};

EntityId entity(std::span<const std::uint8_t> body, std::size_t at) {
  EntityId id{};
  std::copy_n(body.begin() + static_cast<std::ptrdiff_t>(at), id.size(), id.begin());
  return id;
}

/// Reader's id, then writer's id, from `at` on.
bool belongs_to(const ClearChannel& channel, std::span<const std::uint8_t> body, std::size_t at) {
  if (body.size() < at + 8 || entity(body, at + 4) != channel.writer) return false;
  const EntityId reader = entity(body, at);
  return reader == channel.reader || reader == EntityId{};
}

/// A number of a submessage; its flags say how it was written.
std::size_t word(std::span<const std::uint8_t> bytes, std::size_t at, std::uint8_t flags) {
  const bool little = (flags & kLittleEndian) != 0;
  return static_cast<std::size_t>(bytes[at + (little ? 0 : 1)]) |
         static_cast<std::size_t>(bytes[at + (little ? 1 : 0)]) << 8U;
}

/// Whether the parameters beside a sample say that what it is about has ended; also when they
/// cannot be read.
bool tells_an_end(std::span<const std::uint8_t> body, std::uint8_t flags) {
  constexpr std::size_t kOffsetAt = 2;
  constexpr std::size_t kStatus = 0x71;
  constexpr std::size_t kSentinel = 0x01;
  for (std::size_t at = kOffsetAt + 2 + word(body, kOffsetAt, flags); at + 4 <= body.size();) {
    const std::size_t parameter = word(body, at, flags);
    if (parameter == kSentinel) return false;
    if (parameter == kStatus) return true;
    at += 4 + word(body, at + 2, flags);
  }
  return true;
}

MessageKind kind_of_data(std::span<const std::uint8_t> body, std::uint8_t flags) {
  constexpr std::size_t kIds = 4;
  if (belongs_to(kAuthentication, body, kIds)) return MessageKind::kHandshake;
  if (!belongs_to(kAnnouncements, body, kIds)) return MessageKind::kUnsigned;
  const bool lives = (flags & (kHasData | kHasKey)) == kHasData &&
                     ((flags & kInlineQos) == 0 || !tells_an_end(body, flags));
  return lives ? MessageKind::kAnnouncement : MessageKind::kFarewell;
}

/// Of a submessage outside a signature.
MessageKind kind_of_submessage(std::uint8_t id, std::uint8_t flags,
                               std::span<const std::uint8_t> body) {
  switch (id) {
    case kPad:
    case kInfoTimestamp:
    case kInfoDestination:
      return MessageKind::kAnnouncement;
    // The exchange of keys: each submessage is encrypted with what the authentication agreed on.
    case kSecurePrefix:
    case kSecureBody:
    case kSecurePostfix:
      return MessageKind::kHandshake;
    case kData:
      return kind_of_data(body, flags);
    case kAckNack:
    case kHeartbeat:
    case kGap:
      if (belongs_to(kAnnouncements, body, 0)) return MessageKind::kAnnouncement;
      return belongs_to(kAuthentication, body, 0) ? MessageKind::kHandshake
                                                  : MessageKind::kUnsigned;
    default:
      return MessageKind::kUnsigned;
  }
}

}  // namespace

MessageKind classify(std::span<const std::uint8_t> message) {
  if (message.size() < kHeader || !std::equal(kMagic.begin(), kMagic.end(), message.begin()))
    return MessageKind::kMalformed;
  const bool of_fast_dds = message[6] == 0x01 && message[7] == 0x0f;  // vendor
  enum { kNone, kOpen, kClosed } signature = kNone;
  MessageKind clear = MessageKind::kAnnouncement;
  bool first = true;
  for (std::span<const std::uint8_t> rest = message.subspan(kHeader); !rest.empty();) {
    if (rest.size() < kSubmessageHeader) return MessageKind::kMalformed;
    const std::uint8_t id = rest[0];
    const std::uint8_t flags = rest[1];
    std::size_t length = word(rest, 2, flags);
    rest = rest.subspan(kSubmessageHeader);
    // Zero means "to the end of the message", except where a submessage may be empty.
    if (length == 0 && id != kPad && id != kInfoTimestamp) length = rest.size();
    if (length > rest.size()) return MessageKind::kMalformed;
    const auto body = rest.first(length);
    rest = rest.subspan(length);
    if (id == kStatistics && of_fast_dds) {
      if (!rest.empty() || length != kStatisticsLength) return MessageKind::kMalformed;
    } else if (id == kSignedMessagePrefix && first) {
      signature = kOpen;
    } else if (id == kSignedMessagePostfix && signature == kOpen) {
      signature = kClosed;
    } else if (signature != kOpen) {
      clear = std::max(clear, kind_of_submessage(id, flags, body));
    }
    first = false;
  }
  if (signature == kNone || clear != MessageKind::kAnnouncement) return clear;
  return signature == kClosed ? MessageKind::kSigned : MessageKind::kUnsigned;
}

}  // namespace usher::runtime
