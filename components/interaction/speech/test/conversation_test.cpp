#include "interaction/speech/core/conversation.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace usher::speech {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(SpokenWords, AreWhatADictionaryHas) {
  EXPECT_EQ(spoken_words("I am still here"), "i am still here");
  EXPECT_EQ(spoken_words("Where is …"), "where is");
  EXPECT_EQ(spoken_words("Room 3.14"), "room three point one four");
  EXPECT_EQ(spoken_words("AM-102 & Labs"), "am one hundred two and labs");
  EXPECT_EQ(spoken_words("1942, 007, 40, 2000"),
            "nineteen forty two zero zero seven forty two zero zero zero");
  EXPECT_EQ(spoken_words("Café Māori Straße"), "cafe maori strase");
  EXPECT_EQ(spoken_words("Let's go!"), "let's go");
  EXPECT_EQ(spoken_words("… 日本 \xff\xc3"), "");
  EXPECT_EQ(spoken_words(""), "");
}

TEST(Phrases, AreTheButtonsAndAlwaysStop) {
  const Option options[] = {
      {"yes", "Yes", false}, {"query", "Type", true}, {"language:mi", "Māori", false}};
  const auto phrases = phrases_for(options);
  const auto option_of = [&](const std::string& words) -> std::string {
    for (const Phrase& phrase : phrases) {
      if (phrase.words == words) return phrase.option_id;
    }
    return "";
  };
  EXPECT_EQ(option_of("yes"), "yes");
  EXPECT_EQ(option_of("yeah"), "yes");
  EXPECT_EQ(option_of("maori"), "language:mi");
  EXPECT_EQ(option_of("stop"), "stop");
  EXPECT_EQ(option_of("type"), "");
}

TEST(Phrases, AreThereOnceAndBoundedAndTheFirstWins) {
  std::vector<Option> options{{"a", "Back", false}, {"b", "back!", false}};
  EXPECT_EQ(phrases_for(options).size(), 2U);
  EXPECT_EQ(phrases_for(options)[0].option_id, "a");
  for (int i = 0; i < 500; ++i) options.push_back({std::to_string(i), std::to_string(i), false});
  const auto many = phrases_for(options);
  EXPECT_EQ(many.size(), kMostPhrases);
  EXPECT_EQ(many.back().option_id, "stop");
}

TEST(Phrases, BecomeAGrammar) {
  const Phrase phrases[] = {{"yes", "Yes", "yes please"}, {"no", "No", "no"}};
  EXPECT_EQ(jsgf(phrases), "#JSGF V1.0;\ngrammar screen;\npublic <answer> = yes please | no;\n");
}

Hearing hearing(std::size_t phrase, double fit, double margin = 10.0, std::size_t second = 1) {
  return {{{phrase, fit, 0.0}, {second, fit - margin, margin}}};
}

TEST(Judge, ActsWhenSureAsksWhenNotAndIgnoresTheRest) {
  const DecisionRule rule{-10.0, 2.0, -40.0};
  EXPECT_EQ(judge(hearing(0, -5.0), rule), Verdict::kAct);
  EXPECT_EQ(judge(hearing(0, -5.0, 1.0), rule), Verdict::kAsk);
  EXPECT_EQ(judge(hearing(0, -20.0), rule), Verdict::kAsk);
  EXPECT_EQ(judge(hearing(0, -20.0), rule, Stake::kHalt), Verdict::kAct);
  EXPECT_EQ(judge(hearing(0, -41.0), rule, Stake::kHalt), Verdict::kIgnore);
  Hearing noisy = hearing(0, -5.0, 4.5);
  noisy.in_noise = true;
  EXPECT_EQ(judge(noisy, {-12.0, 2.0, -40.0, 6.0, 2.0}), Verdict::kAct);
  EXPECT_EQ(judge(noisy, {-10.0, 2.0, -40.0, 6.0, 2.0}), Verdict::kAsk) << "fit";
  EXPECT_EQ(judge(noisy, {-12.0, 3.0, -40.0, 6.0, 2.0}), Verdict::kAsk) << "margin";
  EXPECT_EQ(judge(noisy, {-10.0, 2.0, -40.0, 6.0, 2.0}, Stake::kHalt), Verdict::kAct) << "a stop";
  EXPECT_EQ(judge(hearing(0, -20.0), rule, Stake::kDenial), Verdict::kAct);
  EXPECT_EQ(judge(hearing(0, -7.0), rule, Stake::kConsent), Verdict::kAsk) << "yes_fit";
  EXPECT_EQ(judge(hearing(0, -5.0), rule, Stake::kConsent), Verdict::kAct);
  EXPECT_EQ(judge({}, rule, Stake::kHalt), Verdict::kIgnore);
  EXPECT_EQ(judge(hearing(0, std::numeric_limits<double>::quiet_NaN()), rule, Stake::kHalt),
            Verdict::kIgnore);
  EXPECT_NEAR(confidence(hearing(0, -10.0), rule), 0.5, 1e-12);
  EXPECT_EQ(confidence(hearing(0, -90.0), rule), 0.0);
  EXPECT_EQ(confidence({}, rule), 0.0);
}

class Talk : public testing::Test {
 protected:
  static constexpr double kSure = 0.0, kUnsure = -20.0, kForeign = -90.0;

  Talk() {
    talk_.can_understand(true);
    talk_.set_sentences({"Did you say {answer}?", "Please touch.", "Stopped."});
  }
  Screen screen(std::uint64_t id, const std::vector<std::string>& options) {
    Screen made;
    made.id = id;
    made.language = "en";
    made.spoken = "Question " + std::to_string(id);
    made.spoken_id = id;
    made.listens = true;
    for (const auto& option : options) made.options.push_back({option, option, false});
    return made;
  }
  void show(const Screen& shown) { talk_.take(shown, now_); }
  /// Time passes, while the robot speaks or not.
  void pass(Time time, bool sounds = false) {
    for (Time end = now_ + time; now_ < end; now_ += milliseconds(20)) talk_.step(sounds, now_);
  }
  void hear(const std::string& words, double fit) {
    for (std::size_t i = 0; i < talk_.phrases().size(); ++i) {
      if (talk_.phrases()[i].words != words) continue;
      hear(hearing(i, fit, 10.0, (i + 1) % talk_.phrases().size()));
      return;
    }
    ADD_FAILURE() << words << " is no phrase";
  }
  void hear(const Hearing& heard) { talk_.heard(heard, talk_.phrases(), talk_.phrases_id(), now_); }
  std::string answer() {
    const Wishes wishes = talk_.take_wishes();
    return wishes.answer ? wishes.answer->option_id : "";
  }

  Conversation talk_{DecisionRule{-10.0, 2.0, -40.0}};
  Time now_{seconds(100)};
};

TEST_F(Talk, SaysEachThingOnceAndANewQuestionBreaksTheOldOneOff) {
  show(screen(1, {"yes", "no"}));
  auto wishes = talk_.take_wishes();
  ASSERT_TRUE(wishes.say.has_value());
  EXPECT_EQ(wishes.say->text, "Question 1");
  show(screen(1, {"yes", "no"}));
  EXPECT_FALSE(talk_.take_wishes().say.has_value());
  auto more = screen(1, {"yes", "no"});
  more.spoken_id = 2;
  show(more);
  wishes = talk_.take_wishes();
  EXPECT_TRUE(wishes.say.has_value());
  EXPECT_FALSE(wishes.break_off) << "more about the same waits its turn";
  auto other = screen(3, {"yes"});
  other.tone = Tone::kMoving;
  show(other);
  wishes = talk_.take_wishes();
  EXPECT_TRUE(wishes.break_off);
  EXPECT_EQ(wishes.tones, std::vector<Tone>{Tone::kMoving});
}

TEST_F(Talk, SoundsAToneThatComesAlone) {
  auto turns = screen(1, {"yes"});
  turns.spoken.clear();
  turns.tone = Tone::kMoving;
  show(turns);
  const auto wishes = talk_.take_wishes();
  EXPECT_EQ(wishes.tones, std::vector<Tone>{Tone::kMoving});
  EXPECT_FALSE(wishes.say);
  show(turns);
  EXPECT_TRUE(talk_.take_wishes().tones.empty()) << "once";
}

TEST_F(Talk, SoundsWhenItBeginsAndWhenItEndsToListen) {
  show(screen(1, {"yes", "no"}));
  talk_.take_wishes();
  pass(seconds(1), true);
  EXPECT_TRUE(talk_.take_wishes().tones.empty()) << "not into its own sentence";
  pass(seconds(1));
  EXPECT_EQ(talk_.take_wishes().tones, std::vector<Tone>{Tone::kListening});
  pass(seconds(5));
  EXPECT_TRUE(talk_.take_wishes().tones.empty());
  auto done = screen(1, {"yes", "no"});
  done.listens = false;
  show(done);
  pass(milliseconds(40));
  EXPECT_EQ(talk_.take_wishes().tones, std::vector<Tone>{Tone::kHeard});
}

TEST_F(Talk, SoundsThatItListensNoMoreWhenTheAnswerSetsTheRobotOff) {
  show(screen(1, {"start", "cancel"})), talk_.take_wishes();
  pass(seconds(1)), talk_.take_wishes();
  auto goes = screen(2, {"stop", "cancel"});
  goes.listens = false;
  goes.tone = Tone::kMoving;
  show(goes);
  EXPECT_EQ(talk_.take_wishes().tones, (std::vector<Tone>{Tone::kHeard, Tone::kMoving}));
  pass(seconds(1));
  EXPECT_TRUE(talk_.take_wishes().tones.empty());
  show(screen(3, {"yes"})), talk_.take_wishes();
  pass(seconds(1)), talk_.take_wishes();
  show(screen(4, {"yes"}));
  EXPECT_TRUE(talk_.take_wishes().tones.empty()) << "it goes on listening";
}

TEST_F(Talk, AnswersWhenSure) {
  show(screen(7, {"yes", "no"}));
  talk_.take_wishes();
  hear("yes", kSure);
  const auto wishes = talk_.take_wishes();
  ASSERT_TRUE(wishes.answer.has_value());
  EXPECT_EQ(wishes.answer->option_id, "yes");
  EXPECT_EQ(wishes.answer->screen_id, 7U);
  EXPECT_TRUE(wishes.break_off) << "barge-in";
  hear("no", kForeign);
  EXPECT_EQ(answer(), "");
  EXPECT_EQ(talk_.counts().acted, 1U);
  EXPECT_EQ(talk_.counts().ignored, 1U);
}

TEST_F(Talk, AsksBackWhenUnsureAndTakesYes) {
  show(screen(7, {"library", "cancel"}));
  talk_.take_wishes();
  hear("library", kUnsure);
  const auto wishes = talk_.take_wishes();
  EXPECT_FALSE(wishes.answer.has_value());
  ASSERT_TRUE(wishes.say.has_value());
  EXPECT_EQ(wishes.say->text, "Did you say library?");
  EXPECT_EQ(talk_.hint(), "Did you say library?");
  EXPECT_TRUE(talk_.asks());
  hear("yes", kUnsure);
  EXPECT_EQ(answer(), "") << "somebody chats nearby";
  EXPECT_EQ(talk_.hint(), "Did you say library?") << "it can still be read and touched";
  hear({{{0, kSure, 0.0}, {3, kSure - 1.0, 1.0}}});
  EXPECT_EQ(answer(), "") << "no clear yes: as like to a no";
  hear("yes", kSure);
  EXPECT_EQ(answer(), "library");
  EXPECT_EQ(talk_.hint(), "");
  EXPECT_EQ(talk_.counts().confirmed, 1U);
}

TEST_F(Talk, NeedNotTellTwoWaysToSayTheSameApart) {
  show(screen(7, {"yes", "no"}));
  talk_.take_wishes();
  ASSERT_EQ(talk_.phrases()[1].words, "yeah");
  hear({{{0, kSure, 0.0}, {1, kSure, 0.1}, {3, kSure - 8.0, 8.0}}});
  EXPECT_EQ(answer(), "yes");
  hear({{{0, kSure, 0.0}, {1, kSure, 0.1}, {3, kSure - 1.0, 1.0}}});
  EXPECT_EQ(answer(), "");
  EXPECT_TRUE(talk_.asks());
  hear({{{96, kSure, 0.0}}});
  EXPECT_EQ(answer(), "") << "what is on no list is nothing";
}

TEST_F(Talk, AsksNobodyWhileTheScreenWaitsForNoAnswer) {
  auto way = screen(7, {"stop", "cancel", "stay", "repeat"});
  way.listens = false;
  show(way);
  talk_.take_wishes();
  EXPECT_FALSE(talk_.awaits_answer());
  for (const char* words : {"repeat", "cancel", "stay"}) {
    hear(words, kUnsure);
    EXPECT_FALSE(talk_.asks()) << words;
    EXPECT_EQ(answer(), "") << words;
  }
  hear("repeat", kSure);
  EXPECT_EQ(answer(), "") << "nobody was asked";
  hear("cancel", kSure);
  EXPECT_EQ(answer(), "cancel");
  hear("stay", kSure);
  EXPECT_EQ(answer(), "stay") << "the robot has lost him and calls";
  hear("stop", kUnsure);
  EXPECT_EQ(answer(), "stop") << "whenever it may be one";
  auto languages = screen(8, {"language:de"});
  languages.listens = false;
  show(languages);
  hear("german", kSure);
  EXPECT_EQ(answer(), "");
  languages.listens = true;
  show(languages);
  hear("german", kSure);
  EXPECT_EQ(answer(), "language:de");
}

TEST_F(Talk, OffersTheSecondAfterNoAndThenGivesUp) {
  show(screen(7, {"library", "cafe"}));
  talk_.take_wishes();
  hear("library", kUnsure);
  talk_.take_wishes();
  hear("no", kUnsure);
  EXPECT_EQ(talk_.take_wishes().say->text, "Did you say cafe?");
  hear("no", kSure);
  EXPECT_EQ(answer(), "");
  EXPECT_FALSE(talk_.asks());
  hear("library", kSure);
  EXPECT_EQ(answer(), "library");
}

TEST_F(Talk, ForgetsAQuestionBackWithoutReplyOrWhenTheScreenChanges) {
  show(screen(7, {"library"}));
  hear("library", kUnsure);
  pass(seconds(20), true);
  EXPECT_TRUE(talk_.asks()) << "patience counts from the end of the sentence";
  pass(Conversation::kPatience + milliseconds(100));
  EXPECT_FALSE(talk_.asks());
  hear("library", kUnsure);
  EXPECT_TRUE(talk_.asks());
  show(screen(8, {"yes"}));
  EXPECT_FALSE(talk_.asks());
}

TEST_F(Talk, IgnoresWhatWasSaidToAnotherScreenButForAStop) {
  show(screen(7, {"yes", "no"}));
  const auto old = talk_.phrases();
  const auto old_id = talk_.phrases_id();
  show(screen(8, {"library", "stop"}));
  talk_.take_wishes();
  talk_.heard(hearing(0, kSure), old, old_id, now_);
  EXPECT_EQ(answer(), "");
  ASSERT_EQ(old.back().option_id, "stop");
  talk_.heard(hearing(old.size() - 1, kUnsure, 10.0, 0), old, old_id, now_);
  EXPECT_EQ(answer(), "stop");
}

TEST_F(Talk, StopsAtOnceHoweverUnsure) {
  show(screen(7, {"stop", "cancel"}));
  talk_.take_wishes();
  hear("stop", kUnsure);
  EXPECT_EQ(answer(), "stop");
  show(screen(8, {"library", "cancel"}));
  hear("library", kUnsure);
  talk_.take_wishes();
  EXPECT_EQ(talk_.hint(), "Did you say library?");
  hear("stop", kUnsure);
  auto wishes = talk_.take_wishes();
  EXPECT_FALSE(wishes.answer.has_value()) << "nothing is called off";
  EXPECT_TRUE(wishes.halt) << "the robot may turn although nothing can be stopped";
  EXPECT_FALSE(talk_.asks());
  EXPECT_EQ(talk_.hint(), "Stopped.");
}

TEST_F(Talk, StopsThroughTheSupervisorWhenTheDialogueDoesNotReact) {
  show(screen(7, {"stop", "cancel"}));
  talk_.take_wishes();
  hear("stop", kSure);
  EXPECT_FALSE(talk_.take_wishes().halt) << "the dialogue can";
  pass(Conversation::kStopLate + milliseconds(40));
  EXPECT_TRUE(talk_.take_wishes().halt);
  EXPECT_TRUE(talk_.holds());
}

TEST_F(Talk, AScreenThatHasNoStopAnyMoreIsNoStop) {
  show(screen(7, {"stop", "cancel"}));
  hear("stop", kSure);
  show(screen(8, {}));
  pass(Conversation::kStopLate + milliseconds(40));
  EXPECT_TRUE(talk_.take_wishes().halt) << "the robot has arrived meanwhile, and may turn";

  talk_.hear_stop(false);
  show(screen(9, {"stop", "done"}));
  hear("stop", kSure);
  talk_.hear_done();
  show(screen(10, {"yes", "no"}));
  pass(Conversation::kStopLate + milliseconds(40));
  EXPECT_FALSE(talk_.take_wishes().halt) << "the dialogue has stopped it";
}

TEST_F(Talk, HoldsWhatStillNavigates) {
  show(screen(7, {"yes"}));
  talk_.hear_visit(true, true);
  hear("stop", kSure);
  talk_.hear_visit(false, true);
  EXPECT_TRUE(talk_.holds()) << "the dialogue has forgotten its visit";
  talk_.hear_visit(false, false);
  EXPECT_FALSE(talk_.holds());
}

TEST_F(Talk, BelievesTheSupervisorWhoseStopHolds) {
  show(screen(7, {"library"}));
  hear("stop", kSure);
  EXPECT_TRUE(talk_.holds());
  EXPECT_FALSE(talk_.hear_stop(true));
  EXPECT_TRUE(talk_.hear_stop(false)) << "an operator lifted it";
  EXPECT_FALSE(talk_.holds());
  EXPECT_EQ(talk_.hint(), "");
  EXPECT_TRUE(talk_.hear_stop(true)) << "it was forgotten here";
  EXPECT_EQ(talk_.hint(), "Stopped.");
}

TEST_F(Talk, AStopSaidAgainChangesNothing) {
  show(screen(7, {"stop", "cancel"}));
  hear("stop", kSure);
  show(screen(8, {"continue", "cancel"}));
  talk_.take_wishes();
  pass(seconds(2));
  hear("stop", kSure);
  const auto wishes = talk_.take_wishes();
  EXPECT_FALSE(wishes.answer.has_value()) << "the visit goes on";
  EXPECT_FALSE(wishes.halt) << "the dialogue holds the robot";
  EXPECT_FALSE(talk_.holds());
  talk_.hear_dialogue(false);
  hear("stop", kSure);
  EXPECT_TRUE(talk_.take_wishes().halt) << "nobody knows what the dialogue does";
}

TEST_F(Talk, StopsWhenTheSecondGuessIsConfirmed) {
  show(screen(7, {"library"}));
  const std::size_t last = talk_.phrases().size() - 1;
  hear(hearing(0, kUnsure, 1.0, last));
  hear("no", kUnsure);
  EXPECT_EQ(talk_.hint(), "Did you say stop?");
  talk_.take_wishes();
  hear("yes", kSure);
  EXPECT_TRUE(talk_.take_wishes().halt);
}

TEST_F(Talk, LiftsItsStopWhenAnAnswerSetsTheRobotOff) {
  show(screen(7, {"yes"}));
  hear("stop", kUnsure);
  now_ += seconds(2);
  show(screen(8, {"stop"}));
  EXPECT_TRUE(talk_.holds()) << "another screen alone is nobody's will";
  talk_.take_wishes();
  auto answered = screen(9, {"yes"});
  answered.answer_client = "tablet";
  answered.answer_id = 4;
  show(answered);
  EXPECT_TRUE(talk_.holds()) << "nor is the answer to a question";
  answered = screen(10, {"stop", "cancel"});
  answered.answer_client = "tablet";
  answered.answer_id = 5;
  show(answered);
  EXPECT_FALSE(talk_.holds());
  EXPECT_TRUE(talk_.take_wishes().go_on);
  talk_.hear_dialogue(false);
  hear("stop", kUnsure);
  talk_.hear_dialogue(true);
  talk_.take_wishes();
  auto begun = screen(11, {"stop", "cancel"});
  begun.answer_client = "tablet";
  begun.answer_id = 6;
  show(begun);
  EXPECT_TRUE(talk_.holds()) << "that was answered before";
  EXPECT_EQ(answer(), "stop") << "the dialogue stops, too";
  hear("stop", kUnsure);
  auto stopped = screen(12, {"continue", "cancel"});
  stopped.answer_client = "tablet";
  stopped.answer_id = 7;
  show(stopped);
  EXPECT_TRUE(talk_.holds()) << "the answer was a stop";
}

TEST_F(Talk, KeepsItsStopOverRestarts) {
  talk_.hold_again();
  auto first = screen(7, {"yes"});
  first.answer_client = "tablet";
  first.answer_id = 4;
  show(first);
  EXPECT_TRUE(talk_.holds()) << "that was answered before it was restarted";
  EXPECT_FALSE(talk_.take_wishes().go_on);
  EXPECT_EQ(talk_.hint(), "Stopped.");
  show(screen(8, {"yes"}));
  EXPECT_TRUE(talk_.holds()) << "the dialogue was restarted: no answer yet";
  auto answered = screen(9, {"stop"});
  answered.answer_client = "tablet";
  answered.answer_id = 1;
  show(answered);
  EXPECT_FALSE(talk_.holds());
  EXPECT_TRUE(talk_.take_wishes().go_on);
}

TEST_F(Talk, LiftsItsStopAtTheEndOfTheVisit) {
  show(screen(7, {"yes"}));
  talk_.hear_visit(false, false);
  hear("stop", kUnsure);
  talk_.take_wishes();
  talk_.hear_visit(false, false);
  EXPECT_TRUE(talk_.holds()) << "nobody was served";
  talk_.hear_visit(true, false);
  EXPECT_TRUE(talk_.holds());
  talk_.hear_visit(false, false);
  EXPECT_FALSE(talk_.holds()) << "the next visitor finds no held robot";
  EXPECT_TRUE(talk_.take_wishes().go_on);
  EXPECT_EQ(talk_.hint(), "");
}

TEST_F(Talk, LiftsItsStopForWhoIsStillHere) {
  show(screen(7, {"yes", "stay"}));
  hear("stop", kUnsure);
  talk_.take_wishes();
  hear("stay", kSure);
  const auto wishes = talk_.take_wishes();
  EXPECT_TRUE(wishes.go_on);
  EXPECT_TRUE(wishes.answer.has_value());
}

TEST_F(Talk, StopsThroughTheSupervisorWhenTheDialogueIsGoneAndGoesOnWhenAsked) {
  show(screen(7, {"stop", "cancel"}));
  talk_.take_wishes();
  talk_.hear_dialogue(false);
  hear("stop", kUnsure);
  EXPECT_TRUE(talk_.take_wishes().halt);
  EXPECT_TRUE(talk_.holds());
  hear("start", kUnsure);
  EXPECT_FALSE(talk_.take_wishes().go_on) << "somebody chats nearby";
  EXPECT_TRUE(talk_.asks());
  hear("yes", kSure);
  EXPECT_TRUE(talk_.take_wishes().go_on);
  EXPECT_FALSE(talk_.holds());
  hear("stop", kUnsure);
  talk_.take_wishes();
  hear("start", kSure);
  EXPECT_TRUE(talk_.take_wishes().go_on);
  EXPECT_FALSE(talk_.holds());
}

TEST_F(Talk, DoesNotListenInOtherLanguagesAndSaysSo) {
  auto german = screen(7, {"yes"});
  german.language = "de";
  show(german);
  EXPECT_FALSE(talk_.listens());
  EXPECT_EQ(talk_.hint(), "Please touch.");
  EXPECT_TRUE(talk_.take_wishes().say.has_value()) << "but it speaks";
  pass(seconds(2));
  EXPECT_TRUE(talk_.take_wishes().tones.empty());
  talk_.can_understand(false);
  auto english = screen(8, {"yes"});
  show(english);
  EXPECT_FALSE(talk_.listens());
  EXPECT_FALSE(talk_.understands());
  EXPECT_EQ(talk_.hint(), "Please touch.") << "without a microphone, too";
  english.listens = false;
  show(english);
  EXPECT_EQ(talk_.hint(), "");
}

}  // namespace
}  // namespace usher::speech
