#include "operations/security/packet_attack.hpp"

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <utility>

namespace usher::operations {

namespace {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

constexpr std::size_t kRtpsHeader = 20;
constexpr std::size_t kPrefixAt = 8;
constexpr std::size_t kPrefix = 12;
constexpr std::uint8_t kLittleEndian = 0x01;
constexpr std::size_t kNumberAt = 16;   // in a data submessage
constexpr std::size_t kPayloadAt = 24;  // the same

/// Where the data submessage of a writer's entity begins in a message, with its header.
std::optional<std::size_t> find_data(View message, const runtime::Guid& writer) {
  constexpr std::size_t kWriterAt = 12;  // header, flags, offset, reader
  for (std::size_t at = kRtpsHeader; at + kWriterAt + 4 <= message.size(); at += 4) {
    if (message[at] == 0x15 &&
        std::equal(writer.begin() + 12, writer.end(),
                   message.begin() + static_cast<std::ptrdiff_t>(at + kWriterAt)))
      return at;
  }
  return std::nullopt;
}

void append(Bytes& bytes, View more) {
  for (const std::uint8_t byte : more) bytes.push_back(byte);
}

template <class Integer>
void append_integer(Bytes& bytes, Integer value) {
  for (std::size_t i = 0; i < sizeof(value); ++i)
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Sequence numbers travel as two words, the higher one first.
void append_number(Bytes& bytes, std::uint64_t number) {
  append_integer(bytes, static_cast<std::uint32_t>(number >> 32U));
  append_integer(bytes, static_cast<std::uint32_t>(number));
}

void append_submessage(Bytes& bytes, std::uint8_t id, std::uint8_t flags, View body) {
  bytes.push_back(id);
  bytes.push_back(flags | kLittleEndian);
  append_integer(bytes, static_cast<std::uint16_t>(body.size()));
  append(bytes, body);
}

Bytes header(View prefix) {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  append(bytes, prefix);
  return bytes;
}

View prefix_of(const runtime::Guid& guid) { return View(guid).first(kPrefix); }
View entity_of(const runtime::Guid& guid) { return View(guid).last(4); }

/// A sample for all matched readers.
void append_sample(Bytes& bytes, const runtime::Guid& writer, std::uint64_t number, View payload) {
  Bytes body{0, 0, 16, 0, 0, 0, 0, 0};  // flags, offset of what follows, any reader
  append(body, entity_of(writer));
  append_number(body, number);
  append(body, payload);
  append_submessage(bytes, 0x15, 0x04, body);
}

void append_source(Bytes& bytes, View prefix) {
  Bytes body{0, 0, 0, 0, 2, 2, 1, 15};
  append(body, prefix);
  append_submessage(bytes, 0x0c, 0, body);
}

/// The 20 bytes of crypto header that a signed message starts with, from one that was heard or made
/// up.
Bytes signed_mark(View heard) {
  constexpr std::size_t kMark = 24;
  if (heard.size() >= kRtpsHeader + kMark && heard[kRtpsHeader] == 0x33) {
    const View mark = heard.subspan(kRtpsHeader, kMark);
    return {mark.begin(), mark.end()};
  }
  Bytes mark;
  append_submessage(mark, 0x33, 0, Bytes(kMark - 4, 0x5a));
  return mark;
}

}  // namespace

Result<PacketTap> PacketTap::open(std::uint32_t domain, const std::string& interface) {
  const int socket =
      ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, htons(ETH_P_IP));
  if (socket < 0)
    return Error{std::string("cannot listen to all packets: ") + std::strerror(errno)};
  const int buffer = 16 << 20;
  ::setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof(buffer));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_IP);
  address.sll_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.sll_ifindex == 0 ||
      ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    const std::string reason = std::strerror(errno);
    ::close(socket);
    return Error{"cannot listen on " + interface + ": " + reason};
  }
  return PacketTap(socket, domain);
}

PacketTap::PacketTap(PacketTap&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), domain_(other.domain_) {}
PacketTap::~PacketTap() {
  if (socket_ >= 0) ::close(socket_);
}

std::optional<Datagram> PacketTap::next_of(const runtime::Guid& writer) {
  constexpr int kMostPackets = 10'000;  // of others, before this one says that none waits
  std::array<std::uint8_t, 65536> packet{};
  for (int i = 0; i < kMostPackets; ++i) {
    sockaddr_ll from{};
    socklen_t from_size = sizeof(from);
    const ssize_t size = ::recvfrom(socket_, packet.data(), packet.size(), 0,
                                    reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) return std::nullopt;
    if (from.sll_pkttype == PACKET_OUTGOING || size < 28) continue;
    const View ip = View(packet).first(static_cast<std::size_t>(size));
    const std::size_t ip_header = static_cast<std::size_t>(ip[0] & 0x0fU) * 4;
    const bool fragment = ((ip[6] & 0x3fU) | ip[7]) != 0;
    if (ip[9] != IPPROTO_UDP || fragment || ip.size() < ip_header + 8 + kRtpsHeader) continue;
    const View udp = ip.subspan(ip_header);
    const auto port = static_cast<std::uint32_t>(udp[2] << 8U | udp[3]);
    const std::uint32_t first = 7400 + 250 * domain_;
    const View message = udp.subspan(8);
    if (port < first || port >= first + 250 ||
        !std::ranges::equal(message.subspan(kPrefixAt, kPrefix), prefix_of(writer)) ||
        !find_data(message, writer))
      continue;
    Datagram heard;
    heard.to.sin_family = AF_INET;
    heard.to.sin_port = htons(static_cast<std::uint16_t>(port));
    std::memcpy(&heard.to.sin_addr, &ip[16], 4);
    heard.bytes.assign(message.begin(), message.end());
    return heard;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> number_of(const Datagram& heard, const runtime::Guid& writer) {
  const auto data = find_data(heard.bytes, writer);
  if (!data || *data + kPayloadAt > heard.bytes.size()) return std::nullopt;
  std::uint64_t number = 0;
  for (const std::size_t word : {std::size_t{0}, std::size_t{4}}) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= static_cast<std::uint32_t>(heard.bytes[*data + kNumberAt + word + i]) << (8 * i);
    number = number << 32U | value;
  }
  return number;
}

const char* to_string(Forgery forgery) {
  switch (forgery) {
    case Forgery::kReplay:
      return "replayed";
    case Forgery::kAltered:
      return "altered";
    case Forgery::kRenumbered:
      return "renumbered";
    case Forgery::kUnsigned:
      return "unsigned";
    case Forgery::kBorrowed:
      return "borrowed source";
    case Forgery::kHidden:
      return "behind a signature's mark";
    case Forgery::kAppended:
      return "after a signed message";
    case Forgery::kStranger:
      return "mark of a stranger";
  }
  return "?";
}

std::vector<std::uint8_t> forge(Forgery forgery, const Datagram& heard, const runtime::Guid& writer,
                                std::span<const std::uint8_t> payload, std::uint64_t number) {
  Bytes bytes = heard.bytes;
  const auto data = find_data(bytes, writer);
  const auto overwrite = [&](std::size_t at, View with) {
    if (data && *data + at + with.size() <= bytes.size())
      std::ranges::copy(with, bytes.begin() + static_cast<std::ptrdiff_t>(*data + at));
  };
  constexpr std::array<std::uint8_t, kPrefix> kStrangersPrefix{9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  switch (forgery) {
    case Forgery::kReplay:
      return bytes;
    case Forgery::kAltered:
      overwrite(kPayloadAt, payload);
      return bytes;
    case Forgery::kRenumbered: {
      Bytes words;
      append_number(words, number);
      overwrite(kNumberAt, words);
      overwrite(kPayloadAt, payload);
      return bytes;
    }
    case Forgery::kUnsigned:
      bytes = header(prefix_of(writer));
      break;
    case Forgery::kBorrowed:
      bytes = header(kStrangersPrefix);
      append_source(bytes, prefix_of(writer));
      break;
    case Forgery::kHidden:
      bytes = header(prefix_of(writer));
      append(bytes, signed_mark(heard.bytes));
      break;
    case Forgery::kAppended:
      break;
    case Forgery::kStranger:
      bytes = header(kStrangersPrefix);
      append(bytes, signed_mark({}));
      append_source(bytes, prefix_of(writer));
      break;
  }
  append_sample(bytes, writer, number, payload);
  return bytes;
}

std::vector<std::vector<std::uint8_t>> sabotage(const runtime::Guid& writer, std::uint64_t number) {
  constexpr std::array<std::uint8_t, 4> kAnnouncer{0x00, 0x01, 0x00, 0xc2};
  constexpr std::array<std::uint8_t, 4> kParticipant{0x00, 0x00, 0x01, 0xc1};
  const Bytes any_reader(4, 0);

  Bytes farewell = header(prefix_of(writer));
  Bytes body{0, 0, 16, 0};
  append(body, any_reader);
  append(body, kAnnouncer);
  append_number(body, number);
  append(body, Bytes{0x71, 0, 4, 0, 0, 0, 0, 3, 0x70, 0, 16, 0});  // disposed; key hash
  append(body, prefix_of(writer));
  append(body, kParticipant);
  append(body, Bytes{1, 0, 0, 0});
  append_submessage(farewell, 0x15, 0x02, body);

  Bytes gap = header(prefix_of(writer));
  body = any_reader;
  append(body, entity_of(writer));
  append_number(body, 1);
  append_number(body, number);
  append_integer(body, std::uint32_t{0});
  append_submessage(gap, 0x08, 0, body);

  Bytes heartbeat = header(prefix_of(writer));
  body = any_reader;
  append(body, entity_of(writer));
  append_number(body, number);
  append_number(body, number);
  append_integer(body, std::uint32_t{0x7fffffff});
  append_submessage(heartbeat, 0x07, 0, body);
  return {farewell, gap, heartbeat};
}

std::vector<std::uint8_t> mangled(View bytes, std::mt19937& random) {
  constexpr std::array<std::uint32_t, 6> kWords{0xffffffff, 0x7fffffff, 0x80000000,
                                                0x7fc00000, 0x7f800000, 0};  // -1 .. NaN, infinite
  Bytes result(bytes.begin(), bytes.end());
  if (result.empty()) return result;
  const auto place = [&](std::size_t size) { return random() % (result.size() - size + 1); };
  switch (random() % 3) {
    case 0:
      result.resize(place(1));
      break;
    case 1:
      for (std::size_t i = 1 + random() % 8; i > 0; --i)
        result[place(1)] = static_cast<std::uint8_t>(random());
      break;
    default:
      if (result.size() < 8) break;
      for (std::size_t i = 1 + random() % 3; i > 0; --i) {
        Bytes word;
        append_integer(word, kWords[random() % kWords.size()]);
        std::ranges::copy(word, result.begin() + static_cast<std::ptrdiff_t>(place(4) / 4 * 4));
      }
  }
  return result;
}

std::vector<std::vector<std::uint8_t>> malformed(const runtime::Guid& writer, View payload,
                                                 std::mt19937& random) {
  constexpr std::size_t kLongest = 1400, kNoises = 40, kMangled = 40;
  const Bytes head = header(prefix_of(writer));
  std::vector<Bytes> all;
  Bytes sample = head;
  append_submessage(sample, 0x80, 0, Bytes(56, 0));
  append_sample(sample, writer, 100, payload);
  for (std::size_t size = 0; size <= sample.size(); ++size)
    all.emplace_back(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(size));

  Bytes ids(4, 0);
  append(ids, entity_of(writer));
  const auto add = [&](std::uint8_t id, std::uint8_t flags, const Bytes& body) {
    Bytes message = head;
    append_submessage(message, id, flags, body);
    all.push_back(message);
    message[kRtpsHeader + 2] = message[kRtpsHeader + 3] = 0xff;  // longer than the message
    all.push_back(std::move(message));
  };
  const auto add_sample = [&](std::uint8_t id, std::uint8_t flags, std::uint16_t offset,
                              const Bytes& rest) {
    Bytes body{0, 0};
    append_integer(body, offset);
    append(body, ids);
    append_number(body, 100);
    append(body, rest);
    add(id, flags, body);
  };
  const Bytes endless{0x0f, 0x80, 0xfc, 0x7f, 0, 0, 0, 0};
  for (const std::uint16_t offset : std::array<std::uint16_t, 5>{0, 15, 0x7fff, 0x8000, 0xffff})
    add_sample(0x15, 0x04, offset, Bytes(payload.begin(), payload.end()));
  add_sample(0x15, 0x06, 16, endless);
  add_sample(0x15, 0x0c, 16, Bytes(payload.begin(), payload.end()));
  for (const std::uint32_t first : {0U, 1U, 0xffffffffU}) {
    for (const std::uint32_t size : {0U, 8U, 0xffffffffU}) {
      Bytes fragment;
      append_integer(fragment, first);
      append_integer(fragment, std::uint16_t{0xffff});
      append_integer(fragment, static_cast<std::uint16_t>(size));
      append_integer(fragment, size);
      append(fragment, Bytes(16, 1));
      add_sample(0x16, 0, 28, fragment);
    }
  }
  for (const std::uint8_t id :
       std::array<std::uint8_t, 3>{0x06, 0x08, 0x12}) {  // sets of numbers, of 4 billion of them
    Bytes body = ids;
    append_number(body, 1);
    if (id == 0x08) append_number(body, 2);
    append_integer(body, ~std::uint32_t{0});
    append_integer(body, ~std::uint32_t{0});
    add(id, 0, body);
  }
  constexpr std::array<std::uint8_t, 11> kOthers{0x07, 0x0c, 0x0d, 0x0e, 0x0f, 0x13,
                                                 0x30, 0x31, 0x32, 0x33, 0x34};
  for (const std::uint8_t id : kOthers) add(id, 0, Bytes(8, 0xff));  // too short, or too much

  for (std::size_t i = 0; i < kNoises; ++i) {
    Bytes message = head;
    for (std::size_t size = random() % kLongest; size > 0; --size)
      message.push_back(static_cast<std::uint8_t>(random()));
    all.push_back(std::move(message));
  }
  Bytes broken = header(Bytes(kPrefix, 9));  // it may come out whole: then it is nobody's
  append_sample(broken, writer, 100, payload);
  for (std::size_t i = 0; i < kMangled; ++i) all.push_back(mangled(broken, random));
  return all;
}

std::vector<sockaddr_in> listeners(std::uint32_t domain) {
  const std::uint32_t first = 7400 + 250 * domain;
  std::vector<sockaddr_in> all;
  const auto add = [&](std::uint32_t address, std::uint32_t port) {
    sockaddr_in& to = all.emplace_back();
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(address);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
  };
  constexpr std::uint32_t kGroup = 0xefff0001;  // 239.255.0.1
  add(kGroup, first);
  std::set<std::uint32_t> ports;
  std::ifstream sockets("/proc/net/udp");
  for (std::string line; std::getline(sockets, line);) {
    const auto colon = line.find(':', line.find(':') + 1);  // number: address:port
    if (colon == std::string::npos) continue;
    const auto port =
        static_cast<std::uint32_t>(std::strtoul(line.c_str() + colon + 1, nullptr, 16));
    if (port >= first + 10 && port < first + 250) ports.insert(port);
  }
  for (const auto port : ports) add(INADDR_LOOPBACK, port);
  return all;
}

PacketSender::PacketSender() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {}
PacketSender::~PacketSender() {
  if (socket_ >= 0) ::close(socket_);
}

bool PacketSender::send(const sockaddr_in& to, std::span<const std::uint8_t> bytes) const {
  return ::sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                  sizeof(to)) == static_cast<ssize_t>(bytes.size());
}

}  // namespace usher::operations
