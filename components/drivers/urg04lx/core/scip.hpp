#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/urg04lx/core/device.hpp"
#include "foundation/estimation/device_clock.hpp"

namespace usher::urg04lx {

/// The character that ends every line of an answer: the sum's low six bits, raised by 30 hex.
char checksum(std::string_view line);

/// A number of two, three or four characters, six bits each; nothing when a character is outside
/// 30..6F hex.
std::optional<std::uint32_t> decode(std::string_view characters);

/// One answer: the echo of the command, its status and the lines of data, without their checksums.
struct Answer {
  std::string_view echo;
  std::string_view status;  ///< two characters; "0" alone is SCIP 1.1's
  std::span<const std::string_view> data;
};

/// Collects the lines of answers from a stream of bytes; an empty line ends an answer. An answer
/// with a line whose checksum is wrong is dropped and counted.
class Reader {
 public:
  static constexpr std::size_t kMaxAnswer = 8192;  ///< [bytes]; the longest real one has 2.2 kB

  void reset();

  /// Calls `on_answer(const Answer&)` for every whole answer; it is valid during the call.
  template <class OnAnswer>
  void feed(std::span<const std::uint8_t> bytes, OnAnswer&& on_answer) {
    for (const std::uint8_t byte : bytes) {
      if (push(static_cast<char>(byte))) {
        if (const auto answer = split()) on_answer(*answer);
        text_.clear();
      }
    }
  }
  std::uint64_t damaged() const { return damaged_; }

 private:
  bool push(char c);
  std::optional<Answer> split();

  std::string text_;
  std::vector<std::string_view> lines_;
  std::uint64_t damaged_ = 0;
};

/// The scanner's own facts, from its answer to PP. The defaults are an URG-04LX.
struct Specification {
  int shortest = 20;   ///< [mm] smaller values are codes
  int longest = 5600;  ///< [mm]
  int steps_per_turn = 1024;
  int first_step = 44;
  int last_step = 725;
  int front_step = 384;  ///< straight ahead
  int turns_per_minute = 600;
};
/// Nothing when a line is missing or the numbers make no scanner.
std::optional<Specification> parse_specification(const Answer& answer);

/// The URG-04LX counts milliseconds in 24 bits.
inline constexpr estimation::DeviceClock::Counter kCounter{.bits = 24,
                                                           .ticks = 1,
                                                           .last = std::chrono::milliseconds(1),
                                                           .restart = std::chrono::seconds(10)};

/// The ranges of an answer to MD or GD over all steps of the specification: its first line is the
/// time stamp, the rest ranges of three characters. False when their number is not that of the
/// steps.
bool parse_scan(const Answer& answer, const Specification& specification, Scan& scan,
                std::uint32_t& counter);

}  // namespace usher::urg04lx
