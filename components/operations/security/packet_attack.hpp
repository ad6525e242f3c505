#pragma once

#include <netinet/in.h>

#include <array>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "runtime/api/ports.hpp"

namespace usher::operations {

// What somebody can do who sits on the network without keys: hear every packet and send any. For
// the experiments and tests that prove that nothing of it is executed.

/// An UDP datagram and where it went.
struct Datagram {
  sockaddr_in to{};
  std::vector<std::uint8_t> bytes;
};

/// Hears the RTPS traffic of one DDS domain on a network interface. Needs the right to open packet
/// sockets (CAP_NET_RAW).
class PacketTap {
 public:
  static Result<PacketTap> open(std::uint32_t domain, const std::string& interface = "lo");
  ~PacketTap();
  PacketTap(PacketTap&& other) noexcept;
  PacketTap& operator=(PacketTap&&) = delete;

  /// The next unfragmented datagram that a writer sent samples with; nothing when none waits. Each
  /// on the loopback is heard once.
  std::optional<Datagram> next_of(const runtime::Guid& writer);

 private:
  PacketTap(int socket, std::uint32_t domain) : socket_(socket), domain_(domain) {}
  int socket_;
  std::uint32_t domain_;
};

/// The sequence number of the writer's sample in a datagram; nothing where there is none.
std::optional<std::uint64_t> number_of(const Datagram& heard, const runtime::Guid& writer);

/// Ways to make a reader take a sample that its writer did not send, or no longer means.
enum class Forgery {
  kReplay,      ///< the same packet again
  kAltered,     ///< another payload under the old signature
  kRenumbered,  ///< a later sequence number under the old signature
  kUnsigned,    ///< a plain sample in the writer's name
  kBorrowed,    ///< a plain sample from somebody else that names the writer as its source
  kHidden,      ///< a plain sample behind the mark of a signed message
  kAppended,    ///< a plain sample after a signed message
  kStranger,    ///< the mark of a signed message from an unknown sender, then a borrowed source
};
inline constexpr std::array kForgeries{Forgery::kReplay,   Forgery::kAltered,  Forgery::kRenumbered,
                                       Forgery::kUnsigned, Forgery::kBorrowed, Forgery::kHidden,
                                       Forgery::kAppended, Forgery::kStranger};
const char* to_string(Forgery forgery);

/// Makes one from a datagram that was heard. `payload` is the serialised sample that shall be taken
/// (with its CDR header), `number` the sequence number that the writer has not reached yet.
std::vector<std::uint8_t> forge(Forgery forgery, const Datagram& heard, const runtime::Guid& writer,
                                std::span<const std::uint8_t> payload, std::uint64_t number);

/// Plain messages in a participant's name that would end what others know of it: its farewell, a
/// gap in a writer's numbers, a heartbeat far ahead of them.
std::vector<std::vector<std::uint8_t>> sabotage(const runtime::Guid& writer, std::uint64_t number);

/// The same bytes with something wrong: an end that is missing, bytes, words or lengths that are
/// others, a number that is none.
std::vector<std::uint8_t> mangled(std::span<const std::uint8_t> bytes, std::mt19937& random);

/// Messages in the name of a writer's participant that are none: a sample behind a submessage of
/// Fast DDS's statistics, whole and cut off at each length; lengths, offsets and counts beyond what
/// is there; noise behind a good header.
std::vector<std::vector<std::uint8_t>> malformed(const runtime::Guid& writer,
                                                 std::span<const std::uint8_t> payload,
                                                 std::mt19937& random);

/// Where participants of a domain listen on this machine: each one's own ports, and the group's.
std::vector<sockaddr_in> listeners(std::uint32_t domain);

/// Sends from an ordinary socket.
class PacketSender {
 public:
  PacketSender();
  ~PacketSender();
  PacketSender(const PacketSender&) = delete;
  PacketSender& operator=(const PacketSender&) = delete;
  bool send(const sockaddr_in& to, std::span<const std::uint8_t> bytes) const;

 private:
  int socket_;
};

}  // namespace usher::operations
