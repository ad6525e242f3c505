#pragma once

#include <string_view>

#include "runtime/api/message_type.hpp"

namespace usher::runtime::test {

/// Bytes from a hex dump; blanks and line ends do not count.
inline Bytes bytes(std::string_view hex) {
  const auto digit = [](char c) {
    return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
  };
  Bytes result;
  int high = -1;
  for (const char c : hex) {
    if (c == ' ' || c == '\n') continue;
    if (high < 0) {
      high = static_cast<int>(digit(c));
    } else {
      result.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(high) * 16U + digit(c)));
      high = -1;
    }
  }
  return result;
}

// Computed by an encoder that knows nothing of Fast CDR, from the ROS 2 definitions.
inline constexpr std::string_view kHeaderVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 0a 00 00 00 62 61 73 65 5f 6c 69 6e 6b 00";
inline constexpr std::string_view kTwistVector =
    "00 01 00 00 00 00 00 00 00 00 e0 3f 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
    "00"
    "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 d0 bf";
inline constexpr std::string_view kTwistStampedVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 0a 00 00 00 62 61 73 65 5f 6c 69 6e 6b 00 00 00 00 00 00 "
    "00"
    "00 00 e0 3f 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
    "00"
    "00 00 00 00 00 00 00 00 00 00 d0 bf";
inline constexpr std::string_view kLaserScanVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 06 00 00 00 6c 61 73 65 72 00 00 00 00 00 c0 bf 00 00 c0 "
    "3f"
    "00 00 c0 3f 00 00 00 00 0a d7 a3 3c 00 00 00 3f 00 00 a0 41 03 00 00 00 00 00 80 3f 00 00 00 "
    "40"
    "00 00 80 7f 00 00 00 00";
inline constexpr std::string_view kJoyVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 04 00 00 00 6a 6f 79 00 02 00 00 00 00 00 00 00 00 00 80 "
    "bf"
    "03 00 00 00 01 00 00 00 00 00 00 00 00 00 00 00";
inline constexpr std::string_view kRangeVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 04 00 00 00 75 73 30 00 00 00 00 00 00 00 00 3f 00 00 80 "
    "3e"
    "00 00 c0 40 00 00 c0 3f";
inline constexpr std::string_view kOccupancyGridVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 04 00 00 00 6d 61 70 00 00 f1 53 65 80 b2 e6 0e cd cc 4c "
    "3d"
    "02 00 00 00 02 00 00 00 00 00 00 00 00 00 00 00 00 00 f0 bf 00 00 00 00 00 00 00 c0 00 00 00 "
    "00"
    "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
    "00"
    "00 00 f0 3f 04 00 00 00 00 64 ff 00";
inline constexpr std::string_view kTransformVector =
    "00 01 00 00 01 00 00 00 00 f1 53 65 80 b2 e6 0e 05 00 00 00 6f 64 6f 6d 00 00 00 00 0a 00 00 "
    "00"
    "62 61 73 65 5f 6c 69 6e 6b 00 00 00 00 00 00 00 00 00 f0 3f 00 00 00 00 00 00 00 40 00 00 00 "
    "00"
    "00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 "
    "00"
    "00 00 f0 3f";
inline constexpr std::string_view kDiagnosticsVector =
    "00 01 00 00 00 f1 53 65 80 b2 e6 0e 01 00 00 00 00 00 00 00 01 00 00 00 01 00 00 00 02 00 00 "
    "00"
    "61 00 00 00 02 00 00 00 62 00 00 00 02 00 00 00 63 00 00 00 01 00 00 00 02 00 00 00 6b 00 00 "
    "00"
    "02 00 00 00 76 00";
inline constexpr std::string_view kGoalStatusVector =
    "00 01 00 00 01 00 00 00 00 01 02 03 04 05 06 07 08 09 0a 0b 0c 0d 0e 0f 00 f1 53 65 80 b2 e6 "
    "0e 04";
inline constexpr std::string_view kClockVector = "00 01 00 00 00 f1 53 65 80 b2 e6 0e";
inline constexpr std::string_view kEmptyVector = "00 01 00 00 00";

}  // namespace usher::runtime::test
