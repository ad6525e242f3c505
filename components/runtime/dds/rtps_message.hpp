#pragma once

#include <cstdint>
#include <span>

namespace usher::runtime {

/// What an RTPS message is to a participant, by its structure alone.
enum class MessageKind {
  kSigned,        ///< the library verifies the signature of the whole message
  kAnnouncement,  ///< in the clear: a participant lives
  kHandshake,     ///< in the clear: the authentication that ends in shared keys, and their exchange
  kFarewell,      ///< in the clear: somebody leaves, or somebody else says so
  kUnsigned,      ///< anything else in the clear
  kMalformed,     ///< no RTPS message, or one that Fast DDS 2.9.1 does not survive
};

/// Reads every byte string, in linear time. Why it is needed: Fast DDS 2.9.1 verifies the messages
/// that are signed but also accepts those that are not, even from a participant that signs, so
/// whoever knows a writer's GUID could command in its name; a statistics submessage that does not
/// end its message ends the process; and it trusts lengths, offsets and counts inside submessages.
/// Signed messages: DDS-Security 1.1, 7.3.6.4; the others: DDSI-RTPS 2.2, 8.3.
MessageKind classify(std::span<const std::uint8_t> message);

/// Whether this is a step of an authentication that goes to a participant that it is not for. Fast
/// DDS 2.9.1 sends every step to everybody: in a robot of 20 participants that is 20 times the
/// work, done when all of them start. DDS-Security 1.1, 7.4.4.
bool is_for_somebody_else(std::span<const std::uint8_t> message);

}  // namespace usher::runtime
