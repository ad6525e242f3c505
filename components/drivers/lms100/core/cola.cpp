#include "drivers/lms100/core/cola.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace usher::lms100 {

namespace {

constexpr std::uint8_t kStx = 0x02;
constexpr std::uint8_t kEtx = 0x03;
constexpr std::size_t kBinaryHeader = 8;

std::string_view as_text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = (value << 8) | byte;
  return value;
}

std::uint8_t exclusive_or(std::span<const std::uint8_t> bytes) {
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : bytes) sum = static_cast<std::uint8_t>(sum ^ byte);
  return sum;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

Decoder::Decoder() : buffer_(2 * (kLongestPayload + kBinaryHeader + 1)) {}

void Decoder::reset() { begin_ = end_ = scanned_ = 0; }

std::size_t Decoder::feed(std::span<const std::uint8_t> bytes) {
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t taken = std::min(bytes.size(), buffer_.size() - end_);
  if (taken > 0) std::memcpy(buffer_.data() + end_, bytes.data(), taken);
  end_ += taken;
  return taken;
}

Decoder::Found Decoder::binary(std::span<const std::uint8_t> bytes, Telegram& telegram) {
  if (bytes.size() < kBinaryHeader) return Found::kNothing;
  const std::size_t length = big_endian(bytes.subspan(4, 4));
  if (length == 0 || length > kLongestPayload) return Found::kSkip;
  if (bytes.size() < kBinaryHeader + length + 1) return Found::kNothing;
  const auto payload = bytes.subspan(kBinaryHeader, length);
  if (exclusive_or(payload) != bytes[kBinaryHeader + length]) {
    ++bad_checksums_;
    return Found::kSkip;
  }
  telegram = {Dialect::kBinary, payload};
  begin_ += kBinaryHeader + length + 1;
  return Found::kTelegram;
}

Decoder::Found Decoder::ascii(std::span<const std::uint8_t> bytes, Telegram& telegram) {
  for (std::size_t i = std::max<std::size_t>(scanned_, 1); i < bytes.size(); ++i) {
    if (bytes[i] == kEtx) {
      telegram = {Dialect::kAscii, bytes.subspan(1, i - 1)};
      begin_ += i + 1;
      return Found::kTelegram;
    }
    if (bytes[i] == kStx || i > kLongestPayload) {  // the end of this one was lost
      skipped_bytes_ += i - 1;
      begin_ += i - 1;
      return Found::kSkip;
    }
  }
  scanned_ = bytes.size();
  return Found::kNothing;
}

std::optional<Telegram> Decoder::next() {
  while (begin_ < end_) {
    const std::span<const std::uint8_t> bytes(buffer_.data() + begin_, end_ - begin_);
    if (bytes[0] != kStx) {
      const auto stx = std::find(bytes.begin(), bytes.end(), kStx);
      const auto skipped = static_cast<std::size_t>(stx - bytes.begin());
      skipped_bytes_ += skipped;
      begin_ += skipped;
      continue;
    }
    if (bytes.size() < 2) return std::nullopt;
    Telegram telegram;
    Found found = Found::kSkip;
    if (bytes[1] == 's') {  // every telegram begins so, and damaged binary rarely does
      found = ascii(bytes, telegram);
    } else if (bytes[1] != kStx) {
      found = Found::kSkip;
    } else if (bytes.size() < 4) {
      if (bytes.size() == 2 || bytes[2] == kStx) return std::nullopt;
    } else if (bytes[2] == kStx && bytes[3] == kStx) {
      found = binary(bytes, telegram);
    }
    if (found == Found::kNothing) return std::nullopt;
    scanned_ = 0;
    if (found == Found::kTelegram) return telegram;
    ++begin_;
    ++skipped_bytes_;
  }
  return std::nullopt;
}

std::string_view FieldReader::token() {
  const std::string_view rest = as_text(rest_);
  const std::size_t blank = rest.find(' ');
  const std::string_view token = rest.substr(0, blank);
  rest_ =
      blank == std::string_view::npos ? std::span<const std::uint8_t>{} : rest_.subspan(blank + 1);
  if (token.empty()) ok_ = false;
  return token;
}

std::uint32_t FieldReader::number(std::size_t width) {
  if (!ok_) return 0;
  if (dialect_ == Dialect::kBinary) {
    if (rest_.size() < width) {
      ok_ = false;
      return 0;
    }
    const std::uint32_t value = big_endian(rest_.first(width));
    rest_ = rest_.subspan(width);
    return value;
  }
  const std::string_view digits = token();
  std::uint32_t value = 0;
  if (digits.size() > 8) ok_ = false;
  for (const char c : digits) {
    const int digit = hex_digit(c);
    if (digit < 0) ok_ = false;
    value = (value << 4) | static_cast<std::uint32_t>(digit & 0xF);
  }
  if (width < 4 && (value >> (8 * width)) != 0) ok_ = false;
  return ok_ ? value : 0;
}

float FieldReader::real() { return std::bit_cast<float>(number(4)); }

std::string_view FieldReader::fixed_text(std::size_t length) {
  if (!ok_) return {};
  if (dialect_ == Dialect::kAscii) {
    const std::string_view text = token();
    if (text.size() != length) ok_ = false;
    return ok_ ? text : std::string_view{};
  }
  if (rest_.size() < length) {
    ok_ = false;
    return {};
  }
  const std::string_view text = as_text(rest_.first(length));
  rest_ = rest_.subspan(length);
  return text;
}

std::string_view FieldReader::text(std::size_t length_width) {
  const std::size_t length = number(length_width);
  if (!ok_ || rest_.size() < length) {
    ok_ = false;
    return {};
  }
  const std::string_view text = as_text(rest_.first(length));
  rest_ = rest_.subspan(length);
  if (dialect_ == Dialect::kAscii && !rest_.empty()) {
    if (rest_.front() != ' ') ok_ = false;
    rest_ = rest_.subspan(1);
  }
  return ok_ ? text : std::string_view{};
}

std::size_t FieldReader::most(std::size_t width) const {
  return dialect_ == Dialect::kBinary ? rest_.size() / width : (rest_.size() + 1) / 2;
}

std::optional<Message> open(const Telegram& telegram) {
  const std::string_view payload = as_text(telegram.payload);
  if (payload.size() < 3 || payload[0] != 's') return std::nullopt;
  Message message;
  message.kind = payload.substr(0, 3);
  if (message.kind == "sFA") {
    // Real devices send the binary code right behind the word, without a blank.
    const std::size_t skip = payload.size() > 3 && payload[3] == ' ' ? 4 : 3;
    message.fields = {telegram.dialect, telegram.payload.subspan(skip)};
    return message;
  }
  if (payload.size() < 5 || payload[3] != ' ') return std::nullopt;
  const std::size_t blank = payload.find(' ', 4);
  message.name = payload.substr(4, blank == std::string_view::npos ? blank : blank - 4);
  if (message.name.empty()) return std::nullopt;
  if (blank != std::string_view::npos) {
    message.fields = {telegram.dialect, telegram.payload.subspan(blank + 1)};
  } else {
    message.fields = {telegram.dialect, {}};
  }
  return message;
}

std::string_view error_text(std::uint32_t code) {
  static constexpr std::array<std::string_view, 27> kTexts{
      "no error",
      "access denied: wrong user level",
      "unknown method",
      "unknown variable",
      "local condition failed: measuring, or a value outside its limits",
      "invalid data",
      "unknown error",
      "too many parameters",
      "too few parameters",
      "unknown type",
      "write access denied",
      "unknown command for the name server",
      "unknown command",
      "method still busy",
      "index out of bounds",
      "unknown event",
      "value overflow",
      "invalid character",
      "no message",
      "no answer",
      "internal error",
      "hub address corrupt",
      "hub address not decoded",
      "hub address exceeded",
      "blank in hub address expected",
      "asynchronous methods are suppressed",
      "complex arrays are not supported"};
  return code < kTexts.size() ? kTexts[code] : "undocumented error";
}

Command::Command(Dialect dialect, std::string_view kind, std::string_view name)
    : dialect_(dialect) {
  payload_.assign(kind.begin(), kind.end());
  payload_.push_back(' ');
  payload_.insert(payload_.end(), name.begin(), name.end());
}

Command& Command::number(std::uint32_t value, std::size_t width) {
  if (dialect_ == Dialect::kAscii) {
    payload_.push_back(' ');
    constexpr char kDigits[] = "0123456789ABCDEF";
    bool leading = true;
    for (int shift = 28; shift >= 0; shift -= 4) {
      const std::uint32_t digit = (value >> shift) & 0xF;
      if (digit != 0 || shift == 0) leading = false;
      if (!leading) payload_.push_back(static_cast<std::uint8_t>(kDigits[digit]));
    }
    return *this;
  }
  if (!has_fields_) payload_.push_back(' ');
  has_fields_ = true;
  for (std::size_t i = width; i-- > 0;) {
    payload_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  return *this;
}

std::vector<std::uint8_t> Command::frame() const {
  std::vector<std::uint8_t> bytes;
  if (dialect_ == Dialect::kAscii) {
    bytes.reserve(payload_.size() + 2);
    bytes.push_back(kStx);
    bytes.insert(bytes.end(), payload_.begin(), payload_.end());
    bytes.push_back(kEtx);
    return bytes;
  }
  bytes.reserve(payload_.size() + kBinaryHeader + 1);
  bytes.assign(4, kStx);
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::uint8_t>(payload_.size() >> shift));
  }
  bytes.insert(bytes.end(), payload_.begin(), payload_.end());
  bytes.push_back(exclusive_or(payload_));
  return bytes;
}

}  // namespace usher::lms100
