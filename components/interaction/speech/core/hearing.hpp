#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "interaction/speech/core/grammar.hpp"

namespace usher::speech {

/// What a recognizer makes of an utterance. Both measures are logarithms of likelihood ratios for a
/// frame of 10 ms, so they depend on neither the length nor the loudness.
struct Hearing {
  struct Candidate {
    std::size_t phrase = 0;  ///< place in the list that was listened for
    double fit = 0.0;        ///< {.., about 0} of its speech, against any sequence of sounds at all
    double behind = 0.0;     ///< {0..} of the whole utterance: how much less likely than the first
  };
  std::vector<Candidate> candidates;  ///< best first; empty: nothing like speech
  bool in_noise = false;              ///< that was taken out: anything fits better then
};

/// The same with one candidate for each option, its best: two ways to say the same need not be told
/// apart. `phrases` is the list that was listened for; candidates beyond it are left out.
Hearing one_for_each_option(const Hearing& hearing, std::span<const Phrase> phrases);

/// What to do about it.
enum class Verdict : std::uint8_t {
  kIgnore,  ///< no answer: noise, or words that were not asked for
  kAsk,     ///< may be an answer: ask back before anything is done
  kAct,     ///< an answer
};

/// What is at stake in taking a phrase for said.
enum class Stake : std::uint8_t {
  kUsual,    ///< an answer
  kHalt,     ///< taken whenever it may have been said
  kDenial,   ///< of a question back: nothing is done
  kConsent,  ///< to a question back: it is done, and who chats nearby must not be taken for it
};

struct DecisionRule {
  double act_fit = -12.0;     ///< at least, to act without asking
  double act_margin = 3.0;    ///< and at least so far before the second
  double ask_fit = -50.0;     ///< at least, to ask
  double noise_fit = 2.0;     ///< so much more fit ...
  double noise_margin = 2.0;  ///< ... and margin it takes to act on what was said in noise
  double stop_fit = -40.0;    ///< at least, to stop; at least ask_fit counts
  double yes_fit = -6.0;      ///< at least, to take a yes for a consent; at least act_fit counts
};

Verdict judge(const Hearing& hearing, const DecisionRule& rule, Stake stake = Stake::kUsual);

/// How sure, for people: 0 at ask_fit, 0.5 at act_fit, towards 1 above.
double confidence(const Hearing& hearing, const DecisionRule& rule);

}  // namespace usher::speech
