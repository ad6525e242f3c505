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

struct DecisionRule {
  double act_fit = -13.0;     ///< at least, to act without asking
  double act_margin = 3.0;    ///< and at least so far before the second
  double ask_fit = -50.0;     ///< at least, to ask
  double noise_fit = 3.0;     ///< so much more fit ...
  double noise_margin = 2.0;  ///< ... and margin it takes to act on what was said in noise
};

/// A stop is an answer whenever it might be one: `always` acts where others are asked about.
Verdict judge(const Hearing& hearing, const DecisionRule& rule, bool always);

/// How sure, for people: 0 at ask_fit, 0.5 at act_fit, towards 1 above.
double confidence(const Hearing& hearing, const DecisionRule& rule);

}  // namespace usher::speech
