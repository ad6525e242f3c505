#include "drivers/serial_frame/core/dialogue.hpp"

#include <utility>

#include "drivers/serial_frame/core/fields.hpp"

namespace usher::serial_frame {

namespace {

constexpr std::uint8_t kHello = 0x01;
constexpr std::uint8_t kHeartbeat = 0x21;
constexpr std::size_t kRequestLength = 2;
constexpr std::size_t kHelloLength = 12;
constexpr std::uint8_t kProtocolVersion = 1;

bool is_hello(std::span<const std::uint8_t> content, std::size_t length) {
  return content.size() == length && content[0] == kHello;
}

}  // namespace

std::optional<Hello> parse_hello(std::span<const std::uint8_t> content) {
  if (!is_hello(content, kHelloLength)) return std::nullopt;
  FieldReader reader(content.subspan(2));
  Hello hello;
  hello.protocol_version = reader.get<std::uint8_t>();
  for (auto& part : hello.firmware) part = reader.get<std::uint8_t>();
  hello.serial_number = reader.get<std::uint32_t>();
  for (auto& count : hello.parts) count = reader.get<std::uint8_t>();
  return hello;
}

bool is_hello_request(std::span<const std::uint8_t> content) {
  return is_hello(content, kRequestLength);
}

Frame hello_request(std::uint8_t sequence) { return FieldWriter(kHello, sequence).frame(); }

Frame heartbeat(std::uint8_t sequence) { return FieldWriter(kHeartbeat, sequence).frame(); }

Frame to_frame(std::uint8_t sequence, const Hello& hello) {
  FieldWriter writer(kHello, sequence);
  writer.put(hello.protocol_version);
  for (const std::uint8_t part : hello.firmware) writer.put(part);
  writer.put(hello.serial_number);
  for (const std::uint8_t count : hello.parts) writer.put(count);
  return writer.frame();
}

void Dialogue::opened(Time now) {
  open_ = true;
  greeted_ = false;
  opened_at_ = now;
  hello_sent_.reset();
  heartbeat_sent_.reset();
  heard_at_.reset();
  last_sequence_.reset();
  status_ = 0;
  refusal_.clear();
  output_.clear();
  decoder_.reset();
}

void Dialogue::closed() {
  open_ = false;
  heard_at_.reset();
  output_.clear();
}

bool Dialogue::take_hello(std::span<const std::uint8_t> content) {
  const auto hello = parse_hello(content);
  if (!hello) return false;
  last_sequence_ = content[1];
  greeted_ = true;
  ++hellos_;
  refusal_.clear();
  const auto [first, second] = parts_;
  if (hello->protocol_version != kProtocolVersion) {
    refusal_ = "expected protocol version 1, the board speaks ";
    refusal_ += std::to_string(hello->protocol_version);
  } else if (hello->parts[0] != first.count || hello->parts[1] != second.count) {
    refusal_ = "expected " + std::to_string(first.count) + " " + first.name + " and ";
    refusal_ += std::to_string(second.count) + " " + second.name + ", the board has ";
    refusal_ += std::to_string(hello->parts[0]) + " and " + std::to_string(hello->parts[1]);
  }
  return true;
}

void Dialogue::count(std::uint8_t sequence) {
  if (last_sequence_) lost_messages_ += static_cast<std::uint8_t>(sequence - *last_sequence_ - 1);
  last_sequence_ = sequence;
}

bool Dialogue::believes(std::uint8_t status, Time now) {
  if ((status & kRebooted) != 0 && (status_ & kRebooted) == 0) {  // and its hello was lost
    greeted_ = false;
    hello_sent_.reset();
    heard_at_.reset();
  }
  status_ = status;
  if (!greeted()) return false;
  heard_at_ = now;
  return true;
}

void Dialogue::tick(Time now) {
  if (!open_ || (!greeted_ && now - opened_at_ < parameters_.boot)) return;
  if (!greeted_ && (!hello_sent_ || now - *hello_sent_ >= parameters_.boot)) {
    send(hello_request(next_sequence()));
    hello_sent_ = now;
  }
  if (!heartbeat_sent_ || now - *heartbeat_sent_ >= parameters_.heartbeat) {
    send(heartbeat(next_sequence()));
    heartbeat_sent_ = now;
  }
}

void Dialogue::send(const Frame& frame) {
  output_.insert(output_.end(), frame.span().begin(), frame.span().end());
}

std::vector<std::uint8_t> Dialogue::take_output() { return std::exchange(output_, {}); }

bool Dialogue::healthy(Time now) const {
  return open_ && refusal_.empty() && heard_at_ && now - *heard_at_ < parameters_.silence;
}

std::string Dialogue::reason(Time now, const char* silent) const {
  if (!open_) return "not connected";
  if (!refusal_.empty()) return refusal_;
  if (!healthy(now)) return heard_at_ ? silent : "waiting for the board";
  return {};
}

std::string describe(std::uint8_t status, std::span<const Trouble> troubles) {
  std::string text;
  for (const Trouble& trouble : troubles) {
    if ((status & trouble.bit) == 0) continue;
    if (!text.empty()) text += ", ";
    text += trouble.meaning;
  }
  return text;
}

}  // namespace usher::serial_frame
