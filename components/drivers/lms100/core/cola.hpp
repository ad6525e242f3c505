#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace usher::lms100 {

/// The two encodings of SICK's command language: blank-separated hexadecimal text between STX and
/// ETX, or big-endian binary with length and checksum.
enum class Dialect : std::uint8_t { kAscii, kBinary };

/// The content of one frame. The payload is valid until the decoder is fed again.
struct Telegram {
  Dialect dialect = Dialect::kAscii;
  std::span<const std::uint8_t> payload;
};

/// Cuts a byte stream into telegrams. A telegram may come in pieces, several at once, in either
/// dialect. After damage it goes on with the next frame that is whole; nothing is delivered twice.
/// Bounded memory, no allocation after construction.
class Decoder {
 public:
  static constexpr std::size_t kLongestPayload = std::size_t{16} * 1024;

  Decoder();

  /// Takes as many bytes as there is room for and says how many. Call next() until it gives
  /// nothing, then feed the rest.
  std::size_t feed(std::span<const std::uint8_t> bytes);

  /// The next whole telegram. Nothing: more bytes are needed.
  std::optional<Telegram> next();

  /// Forgets a half telegram, as after a reconnect.
  void reset();

  std::uint64_t skipped_bytes() const { return skipped_bytes_; }  ///< outside frames or damaged
  std::uint64_t bad_checksums() const { return bad_checksums_; }

 private:
  enum class Found { kNothing, kSkip, kTelegram };
  Found binary(std::span<const std::uint8_t> bytes, Telegram& telegram);
  Found ascii(std::span<const std::uint8_t> bytes, Telegram& telegram);

  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  ///< of what is not consumed
  std::size_t end_ = 0;
  std::size_t scanned_ = 0;  ///< bytes behind begin_ that hold no end of a text frame
  std::uint64_t skipped_bytes_ = 0;
  std::uint64_t bad_checksums_ = 0;
};

/// Reads the fields of a telegram in order, each by the width that it has in the binary dialect.
/// The first field that is missing, malformed or too large for its width makes it fail for good;
/// then all reads give zero.
class FieldReader {
 public:
  FieldReader() = default;
  FieldReader(Dialect dialect, std::span<const std::uint8_t> fields)
      : dialect_(dialect), rest_(fields) {}

  bool ok() const { return ok_; }
  bool done() const { return rest_.empty(); }
  void fail() { ok_ = false; }

  /// Unsigned of 1, 2 or 4 bytes.
  std::uint32_t number(std::size_t width);
  std::int32_t signed_number() { return static_cast<std::int32_t>(number(4)); }
  float real();
  /// Characters without a length in front; in text they end at a blank.
  std::string_view fixed_text(std::size_t length);
  /// Characters behind their number, which has this width; may contain blanks.
  std::string_view text(std::size_t length_width);
  /// How many fields of this width can follow at most; guards allocations.
  std::size_t most(std::size_t width) const;

 private:
  std::string_view token();

  Dialect dialect_ = Dialect::kAscii;
  std::span<const std::uint8_t> rest_;
  bool ok_ = true;
};

/// A telegram taken apart as far as all have in common.
struct Message {
  std::string_view kind;  ///< "sRA", "sWA", "sAN", "sEA", "sSN", "sMA", "sFA"
  std::string_view name;  ///< "LMDscandata"; empty for sFA
  FieldReader fields;
};

/// Nothing when the telegram does not begin as one.
std::optional<Message> open(const Telegram& telegram);

/// What the device means by an sFA code, in words.
std::string_view error_text(std::uint32_t code);

/// Builds a command with its frame.
class Command {
 public:
  /// For example (kBinary, "sMN", "SetAccessMode").
  Command(Dialect dialect, std::string_view kind, std::string_view name);
  Command& number(std::uint32_t value, std::size_t width);
  Command& signed_number(std::int32_t value) {
    return number(static_cast<std::uint32_t>(value), 4);
  }
  /// All bytes to send.
  std::vector<std::uint8_t> frame() const;

 private:
  Dialect dialect_;
  bool has_fields_ = false;
  std::vector<std::uint8_t> payload_;
};

}  // namespace usher::lms100
