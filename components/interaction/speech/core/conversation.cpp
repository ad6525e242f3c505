#include "interaction/speech/core/conversation.hpp"

#include <algorithm>
#include <utility>

#include "interaction/phrases/core/phrase_file.hpp"

namespace usher::speech {

namespace {

constexpr const char* kCancel = "cancel";
constexpr const char* kStart = "start";
constexpr const char* kContinue = "continue";
constexpr const char* kStay = "stay";
constexpr const char* kDone = "done";

/// What may be said to a screen that waits for no answer, besides a stop.
bool unasked(const std::string& option_id) {
  return option_id == kCancel || option_id == kStay || option_id == kDone;
}

}  // namespace

bool Conversation::offers(std::string_view option_id) const {
  return std::any_of(screen_.options.begin(), screen_.options.end(),
                     [&](const Option& option) { return option.id == option_id; });
}

void Conversation::take(const Screen& screen, Time now) {
  const bool another = screen.id != screen_.id;
  const bool more =
      screen.spoken_id > said_ && (!screen.spoken.empty() || screen.tone != Tone::kNone);
  // What comes first after a restart, of this component or of the dialogue, is nobody's answer.
  const bool answered =
      screen_.id != 0 && screen.answer_id != 0 &&
      (screen.answer_id != screen_.answer_id || screen.answer_client != screen_.answer_client);
  screen_ = screen;
  if (offers(kContinue)) halts_at_.reset();  // whatever else has come instead holds nothing
  // An answer, by touch or voice, sets the robot off; unless it was given before the stop.
  const bool sets_off = another && answered && alive_ && offers(kStop);
  const bool late = sets_off && holds_ && stop_.late(now);
  if (sets_off && !late) lift_hold();
  if (another) {
    question_.reset();
    greeted_ear_ = false;
    if (more) wishes_.break_off = true;
    if (waited_ && !screen.listens) wishes_.tones.push_back(Tone::kHeard);
    waited_ = false;
  }
  if (late) {
    answered_ = kStop;
    wishes_.answer = Wishes::Answer{screen_.id, answered_};
  }
  if (more) {
    said_ = screen.spoken_id;
    if (screen.tone != Tone::kNone) wishes_.tones.push_back(screen.tone);
    if (!screen.spoken.empty())
      wishes_.say = Wishes::Say{screen.spoken_id, screen.spoken, screen.language};
  }
  listen();
}

void Conversation::listen() {
  std::vector<Phrase> phrases;
  if (understands() && screen_.id != 0) {
    // Also where only few of them are obeyed: noise that is like one of the others is no stop then.
    std::vector<Option> options = screen_.options;
    if (holds_) options.push_back({kStart, kStart, false});
    phrases = question_ ? phrases_for_question(options) : phrases_for(options);
  }
  if (phrases == phrases_) return;
  phrases_ = std::move(phrases);
  ++phrases_id_;
}

void Conversation::ask(Time now) {
  const Phrase& candidate = question_->candidates[question_->at];
  question_->since = now;
  wishes_.break_off = true;
  wishes_.say =
      Wishes::Say{0, phrases::filled(sentences_.did_you_say, {{"answer", candidate.label}}), "en"};
  listen();
}

void Conversation::answer(const std::string& option_id) {
  question_.reset();
  answered_ = option_id;
  wishes_.break_off = true;
  wishes_.answer = Wishes::Answer{screen_.id, option_id};
}

void Conversation::hear_done() {
  if (answered_ == kStop) halts_at_.reset();
}

void Conversation::stop(Time now) {
  stop_.stop(now);
  question_.reset();
  wishes_.break_off = true;
  const bool stands = alive_ && offers(kContinue);  // the dialogue has stopped it already
  if (alive_ && offers(kStop)) {
    answer(std::string(kStop));
    halts_at_ = now + kStopLate;
  } else if (!stands) {  // nothing to stop, but the robot may turn all the same
    halt();
  }
  listen();
}

void Conversation::halt() {
  halts_at_.reset();
  wishes_.halt = true;
  wishes_.go_on = false;
  holds_ = true;
}

bool Conversation::hear_stop(bool holds) {
  if (holds == holds_) return false;
  holds_ = holds;
  listen();
  return true;
}

void Conversation::lift_hold() {
  if (!holds_) return;
  holds_ = false;
  wishes_.halt = false;
  wishes_.go_on = true;
}

void Conversation::hear_visit(bool served, bool navigates) {
  if (stop_.ends(served, navigates)) lift_hold();
}

/// What was understood for sure: answers the screen, lifts its own stop.
void Conversation::obey(const std::string& option_id, Time now) {
  if (option_id == kStop) return stop(now);  // the second guess, confirmed
  if (option_id == kStart || option_id == kContinue || option_id == kStay) lift_hold();
  if (offers(option_id)) answer(option_id);
}

void Conversation::reply(const Phrase& phrase, Time now) {
  if (phrase.option_id == kYes) {
    ++counts_.confirmed;
    const Phrase confirmed = question_->candidates[question_->at];
    question_.reset();
    wishes_.break_off = true;
    obey(confirmed.option_id, now);
  } else if (phrase.option_id == kNo) {
    ++counts_.denied;
    if (++question_->at < question_->candidates.size()) {
      ask(now);
    } else {
      question_.reset();
      wishes_.break_off = true;
    }
  } else {
    ++counts_.acted;
    question_.reset();
    wishes_.break_off = true;
    obey(phrase.option_id, now);
  }
  listen();
}

void Conversation::heard(const Hearing& utterance, std::span<const Phrase> phrases,
                         std::uint64_t phrases_id, Time now) {
  const Hearing hearing = one_for_each_option(utterance, phrases);
  if (hearing.candidates.empty()) {
    ++counts_.ignored;
    return;
  }
  // By value: the list may be our own, which changes below.
  const auto phrase_of = [&](const Hearing::Candidate& candidate) -> Phrase {
    return phrases[candidate.phrase];
  };
  const Phrase first = phrase_of(hearing.candidates.front());
  const bool stops = first.option_id == kStop;
  const bool in_time = phrases_id == phrases_id_;
  // Who chats nearby must not confirm himself: a yes must be a clear one, a no need not.
  const Stake stake = stops                                  ? Stake::kHalt
                      : question_ && first.option_id == kNo  ? Stake::kDenial
                      : question_ && first.option_id == kYes ? Stake::kConsent
                                                             : Stake::kUsual;
  Verdict verdict = judge(hearing, rule_, stake);
  // While a question back is open, only a clear answer takes its place.
  if (verdict == Verdict::kAsk && (question_ || !screen_.listens)) verdict = Verdict::kIgnore;
  const bool meant = stops || (in_time && (screen_.listens || unasked(first.option_id) ||
                                           (holds_ && first.option_id == kStart)));
  if (!meant) verdict = Verdict::kIgnore;
  last_confidence_ = confidence(hearing, rule_);
  last_heard_ = verdict == Verdict::kIgnore ? "" : first.words;
  if (verdict == Verdict::kIgnore) {
    ++counts_.ignored;
    return;
  }
  if (stops) {
    ++counts_.acted;
    stop(now);
  } else if (question_) {
    reply(first, now);
  } else if (verdict == Verdict::kAct) {
    ++counts_.acted;
    obey(first.option_id, now);
    listen();
  } else {
    Question question;
    for (const auto& candidate : hearing.candidates) {
      if (question.candidates.size() < kMostQuestions)
        question.candidates.push_back(phrase_of(candidate));
    }
    question_ = std::move(question);
    ask(now);
  }
}

void Conversation::step(bool sounds, Time now) {
  if (halts_at_ && now >= *halts_at_) halt();
  if (question_) {
    if (sounds) question_->since = now;
    if (now - question_->since > kPatience) {
      ++counts_.denied;
      question_.reset();
    }
  }
  listen();
  const bool waits = awaits_answer() && !question_;
  if (waits && !greeted_ear_ && !sounds && !wishes_.say) {
    wishes_.tones.push_back(Tone::kListening);
    greeted_ear_ = true;
  }
  if (waited_ && !waits && greeted_ear_ && !question_) wishes_.tones.push_back(Tone::kHeard);
  waited_ = waits && greeted_ear_;
}

Wishes Conversation::take_wishes() { return std::exchange(wishes_, {}); }

std::string Conversation::hint() const {
  if (question_) {
    return phrases::filled(sentences_.did_you_say,
                           {{"answer", question_->candidates[question_->at].label}});
  }
  if (holds_) return sentences_.held;
  return screen_.listens && !understands() ? sentences_.by_touch : std::string();
}

}  // namespace usher::speech
