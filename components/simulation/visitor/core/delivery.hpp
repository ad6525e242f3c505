#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace usher::visitor {

/// How an answer is given.
enum class Means : std::uint8_t { kTouch, kVoice };

/// What a visitor knows of the robot's ear, from what he hears and reads.
struct Ear {
  bool listens = false;  ///< what is said now is heard
  bool sounds = false;   ///< the robot speaks
  bool asks = false;     ///< whether it understood right
  std::string hint;      ///< what it asks, as it stands on the screen
};

/// What to do now: words to say, or the id of a button to touch.
struct Deed {
  Means means = Means::kTouch;
  std::string what;
  bool operator==(const Deed&) const = default;
};

/// Brings an answer to the robot as a person would: lets the robot finish its sentence, speaks,
/// answers questions back truly, says it again when nothing happens, and touches the button in the
/// end, or when nobody listens. Times are seconds on any clock that does not go back.
class Delivery {
 public:
  static constexpr double kSayAgain = 5.0;    ///< [s] after the last time
  static constexpr double kTouchAgain = 1.5;  ///< [s]
  static constexpr double kDeaf = 8.0;        ///< [s] without an ear, then a hand is used
  static constexpr int kMostSaid = 4;         ///< times, then likewise
  static constexpr double kPause = 0.7;       ///< [s] until the robot's question back sounds

  struct Wanted {
    std::uint64_t screen_id = 0;
    std::string option, label;
    Means means = Means::kTouch;
    bool urgent = false;  ///< does not let the robot finish its sentence
  };
  /// The newest answer is the one that counts; the same one again changes nothing.
  void want(Wanted wanted, double now);
  /// Another screen, or one that does not offer it any more: the answer has got there, or comes too
  /// late.
  void see(std::uint64_t screen_id, const std::vector<std::string>& options);
  /// What to do now, if anything; the caller does it at once.
  std::optional<Deed> step(const Ear& ear, double now);

  /// Answers that were meant to be said and were touched.
  std::uint64_t fell_back() const { return fell_back_; }

 private:
  std::optional<Deed> reply(const Ear& ear, double now);
  Deed touch(double now);

  std::optional<Wanted> wanted_;
  std::string label_;      ///< of what was said last
  std::string asked_;      ///< what the robot asks back
  double heard_at_ = 0.0;  ///< when the ear last listened
  double next_at_ = 0.0;
  int said_ = 0;
  std::uint64_t fell_back_ = 0;
};

}  // namespace usher::visitor
