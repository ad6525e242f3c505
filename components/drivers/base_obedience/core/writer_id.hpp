#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

namespace usher::drive {

/// The GUID of a DDS writer or reader: 12 bytes that name the participant, then 4 that name the
/// endpoint. All zero names nobody.
using WriterId = std::array<std::uint8_t, 16>;

inline constexpr WriterId kNobody{};

/// True when both belong to the same participant (process).
inline bool same_participant(const WriterId& a, const WriterId& b) {
  return std::equal(a.begin(), a.begin() + 12, b.begin());
}

/// 32 hexadecimal digits with a dot before the endpoint, for reports to people.
inline std::string to_string(const WriterId& id) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(33);
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (i == 12) text += '.';
    text += kDigits[id[i] >> 4];
    text += kDigits[id[i] & 0xF];
  }
  return text;
}

}  // namespace usher::drive
