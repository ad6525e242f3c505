#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string_view>

namespace usher::operations {

/// Text for people on a descriptor that may take nothing for as long as it likes: a terminal that
/// is paused (Ctrl-S), a pipe that nobody reads. A thread of its own writes; who says something
/// waits for nobody. What the descriptor refuses (a full disk, a reader that has gone) is lost.
class BackgroundOutput {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{64} * 1024;  ///< that wait to be written
  static constexpr auto kFarewell = std::chrono::milliseconds(500);

  explicit BackgroundOutput(int descriptor);
  /// Waits until all is written, but for kFarewell at most.
  ~BackgroundOutput();
  BackgroundOutput(const BackgroundOutput&) = delete;
  BackgroundOutput& operator=(const BackgroundOutput&) = delete;

  /// All of it or, where that would be more than kMostBytes, nothing; how many lines are missing is
  /// said before the next text that has room.
  void say(std::string_view text);
  /// Nothing waits.
  bool idle() const;

 private:
  struct State;
  std::shared_ptr<State> state_;  ///< also the thread's, which may outlive this
};

}  // namespace usher::operations
