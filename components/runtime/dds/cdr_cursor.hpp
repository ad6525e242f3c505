#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "runtime/dds/message_layout.hpp"

namespace usher::runtime {

/// A position in the bytes of a message. Every step checks its bounds; after a failed one ok()
/// stays false and further steps do nothing.
class CdrCursor {
 public:
  /// Starts behind the encapsulation header; not ok when that is not plain XCDR1.
  explicit CdrCursor(std::span<const std::uint8_t> cdr) {
    ok_ = cdr.size() >= 4 && cdr[0] == 0 && cdr[1] <= 1;
    if (!ok_) return;
    big_endian_ = cdr[1] == 0;
    body_ = cdr.subspan(4);
  }

  bool ok() const { return ok_; }
  void fail() { ok_ = false; }
  std::size_t remaining() const { return body_.size() - at_; }

  /// Passes `count` scalars of `size` (1, 2, 4 or 8) bytes and returns the first, null when they
  /// are not there.
  const std::uint8_t* scalars(std::size_t size, std::uint32_t count) {
    const std::size_t padding = (0 - at_) & (size - 1);
    if (!ok_ || padding + size * count > remaining()) {
      ok_ = false;
      return nullptr;
    }
    const std::uint8_t* first = body_.data() + at_ + padding;
    at_ += padding + size * count;
    return first;
  }

  std::uint32_t length() {
    const std::uint8_t* bytes = scalars(4, 1);
    return bytes == nullptr ? 0 : read<std::uint32_t>(bytes);
  }

  /// Passes a string; the view excludes its terminator.
  std::string_view string() {
    const std::uint32_t size = length();
    const std::uint8_t* bytes = scalars(1, size);
    if (bytes == nullptr || size == 0) return {};
    return {reinterpret_cast<const char*>(bytes), size - (bytes[size - 1] == 0 ? 1U : 0U)};
  }

  /// The scalar at `bytes` in this message's byte order; the host is little endian.
  template <class T>
  T read(const std::uint8_t* bytes) const {
    std::uint8_t copy[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i)
      copy[i] = bytes[big_endian_ ? sizeof(T) - 1 - i : i];
    T value;
    std::memcpy(&value, copy, sizeof(T));
    return value;
  }

 private:
  std::span<const std::uint8_t> body_;
  std::size_t at_ = 0;
  bool big_endian_ = false;
  bool ok_ = false;
};

/// Bytes of a scalar on the wire; 0 for strings and structures.
constexpr std::size_t wire_size(FieldKind kind) {
  switch (kind) {
    case FieldKind::kBool:
    case FieldKind::kInt8:
    case FieldKind::kUint8:
      return 1;
    case FieldKind::kInt16:
    case FieldKind::kUint16:
      return 2;
    case FieldKind::kInt32:
    case FieldKind::kUint32:
    case FieldKind::kFloat:
      return 4;
    case FieldKind::kInt64:
    case FieldKind::kUint64:
    case FieldKind::kDouble:
      return 8;
    case FieldKind::kString:
    case FieldKind::kStruct:
      return 0;
  }
  return 0;
}

}  // namespace usher::runtime
