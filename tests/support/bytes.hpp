#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace usher::test {

using Bytes = std::vector<std::uint8_t>;

/// "0A FF 00", as protocols are written down.
inline std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char two[4];
    std::snprintf(two, sizeof two, "%s%02X", text.empty() ? "" : " ", byte);
    text += two;
  }
  return text;
}

}  // namespace usher::test
