#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/serial_frame/core/frame.hpp"

namespace usher::serial_frame {

/// Little-endian fields from the front of a content whose length was checked.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
  template <class Number>
  Number get() {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) value |= std::uint32_t{rest_[i]} << (8 * i);
    rest_ = rest_.subspan(sizeof(Number));
    return static_cast<Number>(value);
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// A content of at most 32 octets: type and sequence, then little-endian fields.
class FieldWriter {
 public:
  FieldWriter(std::uint8_t type, std::uint8_t sequence) { put(type).put(sequence); }
  template <class Number>
  FieldWriter& put(Number number) {
    const auto value = static_cast<std::uint32_t>(number);
    for (std::size_t i = 0; i < sizeof(Number); ++i) {
      bytes_.at(size_++) = static_cast<std::uint8_t>(value >> (8 * i));
    }
    return *this;
  }
  Frame frame() const { return encode(std::span(bytes_).first(size_)); }

 private:
  std::array<std::uint8_t, 32> bytes_{};
  std::size_t size_ = 0;
};

}  // namespace usher::serial_frame
