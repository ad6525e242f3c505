#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "foundation/random/random.hpp"
#include "simulation/visitor/core/delivery.hpp"

namespace usher::visitor {

/// What an ear makes of what is said to it, shares of all utterances; the rest is not heard.
struct HearingRates {
  double understood = 0.48;  ///< at once
  double asked_back = 0.41;  ///< "Did you say ...?", rightly; answered truly
  double mistaken = 0.03;    ///< for another button of the screen
  double confirmed = 0.93;   ///< of the answers to "Did you say ...?": heard
};

/// The robot's ear where no sound is simulated: words take effect as often, and as late, as
/// `usher experiment voice` measured with recorded ones. Who is not heard says it again, and
/// touches in the end, as in Delivery. Times are seconds on any clock that does not go back.
class Hearing {
 public:
  static constexpr double kQuestion = 4.0;  ///< [s] the question back and its answer

  struct Answer {
    std::string option;
    Means means = Means::kVoice;
  };

  Hearing(const HearingRates& rates, Random random) : rates_(rates), random_(random) {}

  /// The newest answer is the one that counts; the same one again changes nothing.
  void want(std::uint64_t screen_id, std::string option, double now);
  /// Another screen, or one that does not offer it any more: the answer has got there, or comes too
  /// late. One that does not listen hears only what may be said unasked.
  void see(std::uint64_t screen_id, std::vector<std::string> options, bool listens);
  /// What reaches the robot now, if anything.
  std::optional<Answer> step(double now);

  std::uint64_t said() const { return said_; }  ///< utterances, answers to questions too
  std::uint64_t asked_back() const { return asked_back_; }
  std::uint64_t mistaken() const { return mistaken_; }
  std::uint64_t fell_back() const { return fell_back_; }  ///< touched in the end

 private:
  std::optional<Answer> other();

  HearingRates rates_;
  Random random_;
  std::uint64_t screen_id_ = 0;
  std::vector<std::string> options_;
  bool listens_ = true;
  std::optional<std::string> wanted_;
  bool asks_ = false;  ///< the robot has asked back
  double next_at_ = 0.0;
  int tries_ = 0;
  std::uint64_t said_ = 0, asked_back_ = 0, mistaken_ = 0, fell_back_ = 0;
};

}  // namespace usher::visitor
