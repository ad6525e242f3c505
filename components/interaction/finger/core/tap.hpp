#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace usher::finger {

/// One touch with a finger.
struct Tap {
  std::uint64_t screen_id = 0;  ///< of the dialogue; where another one is shown, nothing is touched
  bool key = false;             ///< a key of the keyboard, else a button
  std::string target;           ///< the letter, or the button's id; {1..kLongestTarget byte}
  bool operator==(const Tap&) const = default;
};

inline constexpr std::size_t kLongestTarget = 100;  ///< [byte]

/// The line for a tap, with its end. A target may hold spaces but no line's end.
std::string to_line(const Tap& tap);

/// Puts lines together from what arrives of them. Memory is bounded by the longest line.
class Lines {
 public:
  /// The taps of the lines that these bytes end; others are counted.
  std::vector<Tap> take(std::span<const std::uint8_t> bytes);
  /// Forgets a line that has no end: the other side is another one now.
  void restart() { line_.clear(); }
  std::uint64_t rejected() const { return rejected_; }

 private:
  std::string line_;
  std::uint64_t rejected_ = 0;
};

}  // namespace usher::finger
