#include "interaction/speech/core/hearing.hpp"

#include <algorithm>
#include <cmath>

namespace usher::speech {

Hearing one_for_each_option(const Hearing& hearing, std::span<const Phrase> phrases) {
  const auto option = [&](const Hearing::Candidate& candidate) -> const std::string& {
    return phrases[candidate.phrase].option_id;
  };
  Hearing result{{}, hearing.in_noise};
  for (const auto& candidate : hearing.candidates) {
    if (candidate.phrase >= phrases.size()) continue;
    const bool there =
        std::any_of(result.candidates.begin(), result.candidates.end(),
                    [&](const auto& other) { return option(other) == option(candidate); });
    if (!there) result.candidates.push_back(candidate);
  }
  return result;
}

Verdict judge(const Hearing& hearing, const DecisionRule& rule, Stake stake) {
  if (hearing.candidates.empty()) return Verdict::kIgnore;
  const double fit = hearing.candidates.front().fit;
  if (!(fit >= rule.ask_fit)) return Verdict::kIgnore;
  if (stake == Stake::kHalt) return fit >= rule.stop_fit ? Verdict::kAct : Verdict::kIgnore;
  if (stake == Stake::kDenial) return Verdict::kAct;
  const bool alone = hearing.candidates.size() < 2;
  const double margin = rule.act_margin + (hearing.in_noise ? rule.noise_margin : 0.0);
  const double usual = rule.act_fit + (hearing.in_noise ? rule.noise_fit : 0.0);
  const double least = stake == Stake::kConsent ? std::max(usual, rule.yes_fit) : usual;
  const bool clear = alone || hearing.candidates[1].behind >= margin;
  return fit >= least && clear ? Verdict::kAct : Verdict::kAsk;
}

double confidence(const Hearing& hearing, const DecisionRule& rule) {
  if (hearing.candidates.empty()) return 0.0;
  const double fit = hearing.candidates.front().fit;
  if (!std::isfinite(fit)) return 0.0;
  const double span = rule.act_fit - rule.ask_fit;
  return span > 0.0 ? std::clamp(0.5 * (fit - rule.ask_fit) / span, 0.0, 1.0) : 0.0;
}

}  // namespace usher::speech
