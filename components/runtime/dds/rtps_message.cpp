#include "runtime/dds/rtps_message.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

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
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFragments = 0x12,
  kHeartbeatFragment = 0x13,
  kData = 0x15,
  kDataFragment = 0x16,
  kSecureBody = 0x30,
  kSecurePrefix = 0x31,
  kSecurePostfix = 0x32,
  kSignedMessagePrefix = 0x33,
  kSignedMessagePostfix = 0x34,
  kStatistics = 0x80,  // of Fast DDS: it ends each message
};
constexpr std::size_t kStatisticsLength = 56;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::uint8_t kNoTimestamp = 0x02;
constexpr std::uint8_t kInlineQos = 0x02;
constexpr std::uint8_t kHasData = 0x04;
constexpr std::uint8_t kHasKey = 0x08;
constexpr std::uint8_t kKeyFragment = 0x04;

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

std::size_t long_word(std::span<const std::uint8_t> bytes, std::size_t at, std::uint8_t flags) {
  const std::size_t first = word(bytes, at, flags);
  const std::size_t second = word(bytes, at + 2, flags);
  return (flags & kLittleEndian) != 0 ? first | second << 16U : first << 16U | second;
}

/// Bytes of a list of parameters with its end mark; nothing when it does not end within `bytes`.
std::optional<std::size_t> length_of_parameters(std::span<const std::uint8_t> bytes,
                                                std::uint8_t flags) {
  constexpr std::size_t kSentinel = 0x01;
  for (std::size_t at = 0; at + 4 <= bytes.size();) {
    if (word(bytes, at, flags) == kSentinel) return at + 4;
    const std::size_t length = word(bytes, at + 2, flags);
    if (length % 4 != 0) return std::nullopt;
    at += 4 + length;
  }
  return std::nullopt;
}

/// A set of numbers at `at`, whose base takes `base` bytes: count of bits, then the bits.
bool is_set_of_numbers(std::span<const std::uint8_t> body, std::size_t at, std::size_t base,
                       std::size_t after, std::uint8_t flags) {
  constexpr std::size_t kMostBits = 256;
  if (body.size() < at + base + 4) return false;
  const std::size_t bits = long_word(body, at + base, flags);
  return bits <= kMostBits && body.size() >= at + base + 4 + (bits + 31) / 32 * 4 + after;
}

/// What follows the fixed part of a sample that ends at `fixed`: parameters if there are some, then
/// the payload, whose length this is; nothing when they do not fit.
std::optional<std::size_t> length_of_payload(std::span<const std::uint8_t> body, std::size_t fixed,
                                             std::uint8_t flags) {
  constexpr std::size_t kOffsetAt = 2;  // of the offset that is counted from its own end
  if (body.size() < fixed) return std::nullopt;
  constexpr std::size_t kNegative = 0x8000;
  const std::size_t offset = word(body, kOffsetAt, flags);
  const std::size_t begin = kOffsetAt + 2 + offset;
  if (offset >= kNegative || begin < fixed || begin > body.size()) return std::nullopt;
  const std::size_t rest = body.size() - begin;
  if ((flags & kInlineQos) == 0) return rest;
  const auto parameters = length_of_parameters(body.subspan(begin), flags);
  return parameters ? std::optional(rest - *parameters) : std::nullopt;
}

bool is_sound_data(std::span<const std::uint8_t> body, std::uint8_t flags) {
  constexpr std::size_t kFixed = 20;
  constexpr std::size_t kEncapsulation = 4;
  const auto payload = length_of_payload(body, kFixed, flags);
  if (!payload) return false;
  switch (flags & (kHasData | kHasKey)) {
    case 0:
      return true;
    case kHasData | kHasKey:
      return false;
    default:
      return *payload >= kEncapsulation;
  }
}

bool is_sound_fragment(std::span<const std::uint8_t> body, std::uint8_t flags) {
  constexpr std::size_t kFixed = 32;
  constexpr std::size_t kLargestSample = std::size_t{64} << 20U;
  const auto payload = length_of_payload(body, kFixed, flags);
  if (!payload || (flags & kKeyFragment) != 0) return false;
  const std::size_t first = long_word(body, 20, flags);
  const std::size_t count = word(body, 24, flags);
  const std::size_t size = word(body, 26, flags);
  const std::size_t sample = long_word(body, 28, flags);
  if (first == 0 || count == 0 || size == 0 || sample == 0 || sample > kLargestSample) return false;
  const std::size_t last = first + count - 1;
  if (last > (sample + size - 1) / size) return false;
  return *payload >= std::min(count * size, sample - (first - 1) * size);
}

/// Whether a submessage holds what its kind must hold, within its own length.
bool is_sound(std::uint8_t id, std::uint8_t flags, std::span<const std::uint8_t> body) {
  constexpr std::size_t kIds = 8;     // reader's and writer's
  constexpr std::size_t kNumber = 8;  // of a sample
  switch (id) {
    case kData:
      return is_sound_data(body, flags);
    case kDataFragment:
      return is_sound_fragment(body, flags);
    case kHeartbeat:
      return body.size() >= kIds + 2 * kNumber + 4;
    case kHeartbeatFragment:
      return body.size() >= kIds + kNumber + 8;
    case kAckNack:
      return is_set_of_numbers(body, kIds, kNumber, 4, flags);
    case kGap:
      return is_set_of_numbers(body, kIds + kNumber, kNumber, 0, flags);
    case kNackFragments:
      return is_set_of_numbers(body, kIds + kNumber, 4, 4, flags);
    case kInfoTimestamp:
      return (flags & kNoTimestamp) != 0 || body.size() >= 8;
    case kInfoDestination:
      return body.size() >= 12;
    case kInfoSource:
      return body.size() >= 20;
    default:
      return true;
  }
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

bool is_for_somebody_else(std::span<const std::uint8_t> message) {
  constexpr std::size_t kPrefix = 12;
  // Encapsulation, then the identities of the message and of the one that it answers.
  constexpr std::size_t kAddresseeAt = 20 + 4 + 2 * 24;
  if (message.size() < kHeader) return false;
  std::span<const std::uint8_t> to;
  for (auto rest = message.subspan(kHeader); rest.size() >= kSubmessageHeader;) {
    const std::uint8_t id = rest[0];
    const std::uint8_t flags = rest[1];
    const std::size_t length = word(rest, 2, flags);
    rest = rest.subspan(kSubmessageHeader);
    if (length > rest.size()) return false;
    const auto body = rest.first(length);
    rest = rest.subspan(length);
    if (id == kInfoDestination && length >= kPrefix) to = body.first(kPrefix);
    if (id != kData) continue;
    if (to.empty() || (flags & kInlineQos) != 0 || length < kAddresseeAt + kPrefix) return false;
    return belongs_to(kAuthentication, body, 4) &&
           !std::ranges::equal(to, body.subspan(kAddresseeAt, kPrefix));
  }
  return false;
}

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
    // Fast DDS looks for the next one at a multiple of four bytes.
    if ((length % 4 != 0 && !rest.empty()) || !is_sound(id, flags, body))
      return MessageKind::kMalformed;
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
