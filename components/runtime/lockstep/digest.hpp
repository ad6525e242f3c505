#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace usher::runtime {

/// A 64-bit fingerprint of a sequence of byte strings: four independent multiply-and-fold lanes
/// over 32-byte blocks. Not cryptographic; two different runs collide with a probability of about
/// 2^-64.
class Digest {
 public:
  void add(std::uint64_t word) { state_ = mix(state_ ^ word); }

  void add(std::span<const std::uint8_t> bytes) {
    std::array<std::uint64_t, 4> lanes{state_, state_ + kOdd, state_ + 2 * kOdd, state_ + 3 * kOdd};
    std::size_t i = 0;
    for (; i + 32 <= bytes.size(); i += 32) {
      for (std::size_t lane = 0; lane < 4; ++lane) {
        lanes[lane] = mix(lanes[lane] ^ word(bytes.data() + i + 8 * lane, 8));
      }
    }
    for (; i < bytes.size(); i += 8) {
      const std::size_t rest = bytes.size() - i < 8 ? bytes.size() - i : 8;
      lanes[0] = mix(lanes[0] ^ word(bytes.data() + i, rest));
    }
    // The size tells "ab" + "" from "a" + "b".
    state_ = mix(lanes[0] ^ bytes.size());
    for (std::size_t lane = 1; lane < 4; ++lane) state_ = mix(state_ ^ lanes[lane]);
  }

  std::uint64_t value() const { return state_; }

 private:
  static constexpr std::uint64_t kOdd = 0x9e3779b97f4a7c15ULL;

  static std::uint64_t word(const std::uint8_t* bytes, std::size_t count) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes, count);
    return value;
  }
  static std::uint64_t mix(std::uint64_t value) {
    value *= kOdd;
    return value ^ (value >> 32);
  }

  std::uint64_t state_ = kOdd;
};

}  // namespace usher::runtime
