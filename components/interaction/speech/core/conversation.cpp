#include "interaction/speech/core/conversation.hpp"

#include <algorithm>
#include <utility>

#include "interaction/phrases/core/phrase_file.hpp"

namespace usher::speech {

namespace {

constexpr const char* kCancel = "cancel";
constexpr const char* kStart = "start";
constexpr const char* kContinue = "continue";

}  // namespace

bool Conversation::offers(std::string_view option_id) const {
  return std::any_of(screen_.options.begin(), screen_.options.end(),
                     [&](const Option& option) { return option.id == option_id; });
}

void Conversation::take(const Screen& screen, Time /*now*/) {
  const bool another = screen.id != screen_.id;
  const bool more = screen.spoken_id > said_ && !screen.spoken.empty();
  const bool answered =
      screen.answer_id != screen_.answer_id || screen.answer_client != screen_.answer_client;
  screen_ = screen;
  // Whoever answers, by touch or voice, wants it to go on.
  if (another && answered && alive_ && holds_) {
    holds_ = false;
    wishes_.go_on = true;
  }
  if (another) {
    question_.reset();
    greeted_ear_ = false;
    if (more) wishes_.break_off = true;
  }
  if (more) {
    said_ = screen.spoken_id;
    if (screen.tone != Tone::kNone) wishes_.tones.push_back(screen.tone);
    wishes_.say = Wishes::Say{screen.spoken_id, screen.spoken, screen.language};
  }
  listen();
}

void Conversation::listen() {
  std::vector<Phrase> phrases;
  if (able_ && english() && screen_.id != 0) {
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
  wishes_.break_off = true;
  wishes_.answer = Wishes::Answer{screen_.id, option_id};
}

void Conversation::stop() {
  question_.reset();
  wishes_.break_off = true;
  if (alive_ && offers(kStop)) {
    answer(std::string(kStop));
  } else if (alive_ && offers(kCancel)) {
    answer(kCancel);
  } else {  // the dialogue is gone or has nothing to stop; the robot may turn all the same
    wishes_.halt = true;
    holds_ = true;
  }
  listen();
}

/// What was understood for sure: answers the screen, lifts its own stop.
void Conversation::obey(const std::string& option_id) {
  if (holds_ && (option_id == kStart || option_id == kContinue)) {
    holds_ = false;
    wishes_.go_on = true;
  }
  if (offers(option_id)) answer(option_id);
}

void Conversation::reply(const Phrase& phrase, Time now) {
  if (phrase.option_id == kYes) {
    ++counts_.confirmed;
    const Phrase confirmed = question_->candidates[question_->at];
    question_.reset();
    wishes_.break_off = true;
    obey(confirmed.option_id);
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
    answer(phrase.option_id);
  }
  listen();
}

void Conversation::heard(const Hearing& hearing, std::uint64_t phrases_id, Time now) {
  const auto phrase_of = [&](std::size_t i) {
    return phrases_[std::min(hearing.candidates[i].phrase, phrases_.size() - 1)];
  };
  if (phrases_id != phrases_id_ || hearing.candidates.empty() || phrases_.empty()) {
    ++counts_.ignored;
    return;
  }
  const Phrase first = phrase_of(0);
  const bool stops = first.option_id == kStop;
  const bool answers_question = question_ && (first.option_id == kYes || first.option_id == kNo);
  Verdict verdict = judge(hearing, rule_, stops || answers_question);
  // While a question back is open, only a clear answer takes its place.
  if (question_ && verdict == Verdict::kAsk) verdict = Verdict::kIgnore;
  last_confidence_ = confidence(hearing, rule_);
  last_heard_ = verdict == Verdict::kIgnore ? "" : first.words;
  if (verdict == Verdict::kIgnore) {
    ++counts_.ignored;
    return;
  }
  if (stops) {
    ++counts_.acted;
    stop();
  } else if (question_) {
    reply(first, now);
  } else if (verdict == Verdict::kAct) {
    ++counts_.acted;
    obey(first.option_id);
    listen();
  } else {
    Question question;
    for (std::size_t i = 0; i < hearing.candidates.size(); ++i) {
      const Phrase phrase = phrase_of(i);
      const bool there =
          std::any_of(question.candidates.begin(), question.candidates.end(),
                      [&](const Phrase& other) { return other.option_id == phrase.option_id; });
      if (!there && question.candidates.size() < kMostQuestions)
        question.candidates.push_back(phrase);
    }
    question_ = std::move(question);
    ask(now);
  }
}

void Conversation::step(bool sounds, Time now) {
  if (question_) {
    if (sounds) question_->since = now;
    if (now - question_->since > kPatience) {
      ++counts_.denied;
      question_.reset();
    }
  }
  listen();
  const bool waits = listens() && screen_.listens && !question_;
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
  return screen_.listens && !english() ? sentences_.by_touch : std::string();
}

}  // namespace usher::speech
