#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "interaction/own_stop/core/visits_stop.hpp"
#include "interaction/speech/core/grammar.hpp"
#include "interaction/speech/core/hearing.hpp"
#include "interaction/speech/core/tones.hpp"

namespace usher::speech {

using Time = std::chrono::nanoseconds;

/// What the dialogue says and waits for.
struct Screen {
  std::uint64_t id = 0;
  std::string language;
  std::string spoken;
  std::uint64_t spoken_id = 0;
  Tone tone = Tone::kNone;
  bool listens = false;
  std::string answer_client;    ///< whose answer the dialogue took last, ...
  std::uint64_t answer_id = 0;  ///< ... and which
  std::vector<Option> options;
};

/// What the conversation wants of the others, in this order.
struct Wishes {
  bool break_off = false;  ///< what is being said
  std::vector<Tone> tones;
  struct Say {
    std::uint64_t id = 0;  ///< the dialogue's, 0 = our own
    std::string text, language;
  };
  std::optional<Say> say;
  struct Answer {
    std::uint64_t screen_id = 0;
    std::string option_id;
  };
  std::optional<Answer> answer;
  bool halt = false;   ///< the supervisor shall stop the robot, since no dialogue can
  bool go_on = false;  ///< and let it move again
};

enum class Text : std::size_t { kDidYouSay, kByTouch, kHeld };
inline constexpr std::array<std::string_view, 3> kTextKeys{"did_you_say", "by_touch", "held"};

/// Our own sentences, in the language of the dialogue.
struct Sentences {
  std::string did_you_say;  ///< with {answer}
  std::string by_touch;     ///< when nothing that is said is understood
  std::string held;         ///< while the robot stands by our stop
};

/// Who speaks when, and what an answer is. Says what a screen wants said, once for each spoken_id:
/// a new question breaks the old one off, more about the same waits its turn. Takes what was heard
/// for an answer only when it is sure, else asks back; a stop it takes at once. A screen that waits
/// for no answer is left alone by all who talk nearby: only who is sure to call the journey off, or
/// says that he is still here, is heard besides a stop, and nobody is asked back.
class Conversation {
 public:
  /// How long a question back waits.
  static constexpr Time kPatience = std::chrono::seconds(8);
  static constexpr int kMostQuestions = 2;  ///< about one utterance
  /// A dialogue that has not stopped the robot by then is not waited for.
  static constexpr Time kStopLate = std::chrono::milliseconds(500);

  explicit Conversation(const DecisionRule& rule) : rule_(rule) {}

  /// Languages that the recognizer knows: English or none.
  void can_understand(bool able) { able_ = able; }
  void set_sentences(Sentences sentences) { sentences_ = std::move(sentences); }
  void take(const Screen& screen, Time now);
  /// The dialogue is heard from or is not.
  void hear_dialogue(bool alive) { alive_ = alive; }
  /// The dialogue has done what our newest answer says.
  void hear_done();
  /// Somebody is served or not, the supervisor navigates or not. The end of a visit ends our stop,
  /// too: the next visitor finds no held robot. A dialogue that forgets its visit has not ended the
  /// journey.
  void hear_visit(bool served, bool navigates);
  /// What was heard, with the phrases that it was listened for and their number. A stop is one
  /// whatever has come to the screen since; anything else was said to the buttons of then.
  void heard(const Hearing& hearing, std::span<const Phrase> phrases, std::uint64_t phrases_id,
             Time now);
  /// The robot's voice sounds or not; call often.
  void step(bool sounds, Time now);
  Wishes take_wishes();

  /// What may be said now; a new number whenever it changes. Empty: nobody listens.
  const std::vector<Phrase>& phrases() const { return phrases_; }
  std::uint64_t phrases_id() const { return phrases_id_; }
  bool listens() const { return !phrases_.empty(); }
  /// Answers may be spoken in the language of the dialogue.
  bool understands() const { return able_ && english(); }
  /// A question is open, and may be answered by voice.
  bool awaits_answer() const { return listens() && screen_.listens; }
  bool asks() const { return question_.has_value(); }
  /// What the visitor should read besides the screen; empty: nothing.
  std::string hint() const;
  const std::string& last_heard() const { return last_heard_; }
  double last_confidence() const { return last_confidence_; }
  /// Answers since the start: given at once, after a question, denied or unanswered, ignored.
  struct Counts {
    std::uint64_t acted = 0, confirmed = 0, denied = 0, ignored = 0;
  };
  const Counts& counts() const { return counts_; }
  bool holds() const { return holds_; }
  /// After a restart while the robot was stopped through us.
  void hold_again() { holds_ = true; }
  /// What the supervisor says of our stop. False when it is as was known.
  bool hear_stop(bool holds);

 private:
  struct Question {
    std::vector<Phrase> candidates;  ///< the first is asked about
    std::size_t at = 0;
    Time since{};
  };
  bool english() const { return screen_.language == "en"; }
  bool offers(std::string_view option_id) const;
  void listen();
  void ask(Time now);
  void answer(const std::string& option_id);
  void stop(Time now);
  void halt();
  void lift_hold();
  void obey(const std::string& option_id, Time now);
  void reply(const Phrase& phrase, Time now);

  DecisionRule rule_;
  Sentences sentences_;
  Screen screen_;
  std::uint64_t said_ = 0;
  bool able_ = false, alive_ = true;
  bool holds_ = false, waited_ = false, greeted_ear_ = false;
  std::string answered_;          ///< our newest answer
  own_stop::VisitsStop stop_;     ///< the visitor's newest, by voice
  std::optional<Time> halts_at_;  ///< unless the dialogue has stopped the robot by then
  std::optional<Question> question_;
  std::vector<Phrase> phrases_;
  std::uint64_t phrases_id_ = 0;
  Wishes wishes_;
  std::string last_heard_;
  double last_confidence_ = 0.0;
  Counts counts_;
};

}  // namespace usher::speech
