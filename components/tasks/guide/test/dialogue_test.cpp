#include "tasks/guide/core/guide.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "foundation/random/random.hpp"
#include "visit_rig.hpp"

namespace usher::guide {
namespace {

// They need not be said: there are robots without speech, and languages that it does not
// understand.
TEST(Guide, NamesTheButtonThatItWaitsFor) {
  constexpr std::array<std::pair<Text, Text>, 6> kNames{{{Text::kLocationShow, Text::kDone},
                                                         {Text::kPlaceShow, Text::kDone},
                                                         {Text::kTellWhenReady, Text::kStart},
                                                         {Text::kLetsGo, Text::kStop},
                                                         {Text::kTellWhenToGoOn, Text::kGoOn},
                                                         {Text::kWalkAhead, Text::kDone}}};
  const auto texts = book();
  for (std::size_t language = 0; language < texts.languages().size(); ++language) {
    for (const auto& [sentence, button] : kNames) {
      const auto& said = texts.phrase(language, static_cast<std::size_t>(sentence));
      const auto& label = texts.phrase(language, static_cast<std::size_t>(button));
      EXPECT_NE(said.find(label), std::string::npos) << said << " does not name " << label;
    }
  }
}

TEST(Guide, SpeaksTheSentencesOfTheThesis) {
  Rig rig;
  EXPECT_EQ(rig.guide.screen().title, "Hello, I am MARVIN.");
  rig.to_location_ask();
  EXPECT_EQ(rig.guide.screen().title, "Would you like to see our location?");
  rig.press("yes");
  EXPECT_EQ(rig.guide.screen().title, "Here is our location, choose Done when you have seen it.");
  EXPECT_EQ(rig.guide.screen().text, "We are here – CO239.") << "the nearest place";
  rig.around.pose->y = 3.0, rig.wait(100);
  EXPECT_EQ(rig.guide.screen().text, "Close to us – CO239.");
  rig.press("done");
  EXPECT_EQ(rig.guide.screen().title, "Would you like me to guide you somewhere?");
  rig.press("yes");
  EXPECT_EQ(rig.guide.screen().title, "Where would you like to go?");
  EXPECT_EQ(rig.guide.screen().options[0], (Option{"am218", "AM218"}));
  rig.press("am218");
  EXPECT_EQ(rig.guide.screen().title, "Your destination: AM218.");
  EXPECT_EQ(rig.guide.screen().text, "Choose Start when you are ready to go.");
  rig.press("start");
  EXPECT_EQ(rig.guide.screen().text, "All right, let's go. Choose Stop if we need to stop.");
  EXPECT_EQ(rig.guide.screen().tone, Tone::kMoving);
  rig.wait(1000);
  rig.navigate(GoalState::kFailed);
  EXPECT_EQ(rig.guide.screen().title, "Sorry, I was unable to guide you.");
  rig.press("no");
  EXPECT_EQ(rig.guide.screen().title, "Can I do anything else for you?");
  rig.press("no");
  EXPECT_EQ(rig.guide.screen().title, "OK, See you later.");
}

TEST(Guide, SaysOnlyWhatIsOnTheScreen) {
  for (const char* language : {"en", "mi", "de", "fr"}) {
    Rig rig;
    const auto check = [&](const char* where) {
      const Screen& screen = rig.guide.screen();
      EXPECT_NE((screen.title + " " + screen.text).find(screen.spoken), std::string::npos)
          << language << " " << where << ": " << screen.spoken;
      EXPECT_EQ(screen.language, language);
    };
    rig.press(std::string("language:") + language);
    check("introduction");
    rig.wait(3000), check("location ask");
    rig.press("yes"), check("map");
    rig.press("where_is"), check("which");
    rig.press("foyer"), check("place");
    rig.press("guide_me"), check("start");
    rig.press("start"), check("active");
    rig.wait(1000);
    rig.navigate(GoalState::kSucceeded), check("arrived");
    rig.wait(4000), check("anything else");
    rig.wait(41000), check("still there");
  }
}

TEST(Guide, KeepsTheLanguageForTheVisitAndForgetsItAfter) {
  Rig rig;
  rig.press("language:de");
  rig.wait(3000);
  EXPECT_EQ(rig.guide.screen().title, "Möchten Sie sehen, wo wir sind?");
  rig.wait(60000);
  EXPECT_EQ(rig.state(), "end");
  EXPECT_EQ(rig.guide.screen().language, "de");
  rig.wait(4000);
  EXPECT_EQ(rig.guide.screen().language, "en");
}

TEST(Guide, IgnoresStaleRepeatedAndForeignAnswers) {
  Rig rig;
  rig.to_location_ask();
  const std::uint64_t ask = rig.guide.screen().id;
  rig.press("guide_me");
  const std::uint64_t options = rig.guide.screen().id;
  EXPECT_GT(options, ask);
  rig.note(rig.guide.answer({ask, "yes"}, rig.now()));  // a touch that comes late
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kLate);
  rig.note(rig.guide.answer({options, "yes"}, rig.now()));  // not on this screen
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kNotOffered);
  rig.note(rig.guide.answer({0, ""}, rig.now()));
  EXPECT_EQ(rig.state(), "guide_options");
  EXPECT_EQ(rig.guide.ignored_answers(), 3U);
  rig.note(rig.guide.answer({options, "am218"}, rig.now()));
  rig.note(rig.guide.answer({options, "co239"}, rig.now()));  // the second of two voices
  EXPECT_EQ(rig.state(), "guide_start");
  EXPECT_EQ(rig.taken(), "start:am218");
}

TEST(Guide, RepliesToARepeatedAnswerButActsOnce) {
  Rig rig;
  rig.begin();
  rig.wait(3000);
  const Answer answer{rig.guide.screen().id, "guide_me", "", Input::kTouch, "tablet", 7};
  EXPECT_TRUE(rig.guide.answer(answer, rig.now()).screen_changed);
  EXPECT_EQ(rig.guide.last_answer().id, 7U);
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kDone);
  const auto screen = rig.guide.screen().id;
  EXPECT_TRUE(rig.guide.answer(answer, rig.now()).screen_changed) << "the reply again";
  EXPECT_EQ(rig.guide.screen().id, screen);
  EXPECT_EQ(rig.guide.ignored_answers(), 0U);
}

TEST(Guide, AnnouncesATimeOutAndGivesMoreTime) {
  Rig rig;
  rig.to_location_ask();
  rig.wait(39900);
  EXPECT_TRUE(std::isnan(rig.guide.screen().time_left));
  EXPECT_FALSE(rig.offers("stay"));
  for (int extension = 0; extension < 12; ++extension) {
    rig.wait(200);
    ASSERT_NEAR(rig.guide.screen().time_left, 20.0, 1.0) << "20 s to extend by one touch";
    ASSERT_EQ(rig.guide.screen().text, "Are you still there?");
    ASSERT_TRUE(rig.offers("stay"));
    rig.wait(10000);
    rig.press("stay");
    ASSERT_TRUE(std::isnan(rig.guide.screen().time_left));
    rig.wait(39900);
  }
  EXPECT_EQ(rig.state(), "location_ask");
}

TEST(Guide, RepeatsWhatItSaid) {
  Rig rig;
  rig.to_location_ask();
  const auto count = rig.said.size();
  const auto id = rig.guide.screen().id;
  rig.press("repeat");
  ASSERT_EQ(rig.said.size(), count + 1);
  EXPECT_EQ(rig.said.back(), rig.said[count - 1]);
  EXPECT_EQ(rig.guide.screen().id, id);
}

TEST(Guide, SeeksOnlyWhereSomebodyLooksAndSeesNobody) {
  Rig rig;
  EXPECT_FALSE(rig.guide.seeks()) << "nobody looks: a turn would find nobody";
  rig.see_nobody();
  rig.wait(100);
  EXPECT_EQ(rig.toned_ms, rig.now_ms);
  rig.wait(900);
  EXPECT_FALSE(rig.guide.seeks()) << "a tone before the first motion";
  rig.wait(100);
  EXPECT_TRUE(rig.guide.seeks());
  EXPECT_TRUE(rig.said.empty()) << rig.said.back();
  rig.around.permission = Permission::kStopped, rig.wait(2000);
  EXPECT_FALSE(rig.guide.seeks());
  rig.around.permission = Permission::kGiven, rig.wait(900);
  EXPECT_FALSE(rig.guide.seeks()) << "likewise after somebody's stop";
  rig.wait(200);
  EXPECT_TRUE(rig.guide.seeks());
  rig.see(3.0);
  rig.wait(100);
  EXPECT_FALSE(rig.guide.seeks()) << "somebody may come up";
  rig.see_nobody();
  rig.wait(1200);
  EXPECT_TRUE(rig.guide.seeks());
  rig.begin();
  EXPECT_FALSE(rig.guide.seeks()) << "somebody touched the screen";
}

TEST(Guide, GreetsOncePerEncounterAndNotWhoPassesBy) {
  Rig rig;
  rig.see(1.5, 1.3);
  rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive") << "passes by";
  rig.see(-1.5, 0.0);
  rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive") << "stands behind";
  EXPECT_FALSE(rig.guide.seeks()) << "somebody is there";
  rig.see(1.5, 0.2);
  rig.wait(1200);
  EXPECT_EQ(rig.state(), "introduction");
  rig.wait(3000);
  rig.press("no"), rig.press("no"), rig.press("no");
  rig.wait(70000);
  EXPECT_EQ(rig.state(), "inactive") << "the same visitor is not greeted again";
  rig.see_nobody();
  rig.wait(16000);
  EXPECT_TRUE(rig.guide.seeks());
  rig.see(1.5, 0.2);
  rig.wait(1200);
  EXPECT_EQ(rig.state(), "introduction");
  EXPECT_EQ(rig.guide.funnel().greeted, 2U);
  EXPECT_EQ(rig.guide.funnel().engaged, 1U);
}

TEST(Guide, OffersNothingWhileTheRobotIsNotReady) {
  Rig rig;
  for (const Supervisor supervisor :
       {Supervisor::kUnknown, Supervisor::kNotReady, Supervisor::kInactive, Supervisor::kManual,
        Supervisor::kFault}) {
    rig.around.supervisor = supervisor;
    rig.see(1.0);
    rig.wait(5000);
    EXPECT_EQ(rig.guide.state(), State::kInitialise);
    EXPECT_TRUE(rig.guide.screen().options.empty());
    EXPECT_FALSE(rig.guide.screen().text.empty());
  }
}

TEST(Guide, KnowsNoPlacesUntilItIsTold) {
  Guide guide({}, book(), 1, {}, {});
  Surroundings around;
  around.supervisor = Supervisor::kAvailable;
  guide.step(around, Time(0));
  EXPECT_EQ(guide.screen().text, "I do not know any places yet.");
  ASSERT_TRUE(guide.set_locations(rooms(), Time(0)).ok());
  guide.step(around, Time(0));
  EXPECT_EQ(guide.screen().options.size(), 4U) << "a button for each language";
}

TEST(Guide, ARepeatGivesTheWholeTimeAgainWithAWarningBeforeItsEnd) {
  Rig rig;
  rig.to_location_ask();
  rig.wait(45000);
  ASSERT_EQ(rig.said.back(), "Are you still there?");
  rig.press("repeat");
  EXPECT_EQ(rig.said.back(), "Would you like to see our location?");
  EXPECT_TRUE(std::isnan(rig.guide.screen().time_left));
  EXPECT_EQ(rig.guide.screen().text, "");
  rig.wait(39900);
  EXPECT_TRUE(std::isnan(rig.guide.screen().time_left));
  rig.wait(200);
  EXPECT_EQ(rig.said.back(), "Are you still there?");
  EXPECT_TRUE(rig.offers("stay"));
}

TEST(Guide, LetsItselfFinishBeforeTheNextScreen) {
  Rig rig;
  rig.around.speech = Speech{0, true};  // it has not heard of the greeting yet
  rig.begin();
  rig.wait(3500);
  EXPECT_EQ(rig.state(), "introduction");
  rig.around.speech = Speech{rig.guide.screen().spoken_id, false};
  rig.wait(1000);
  EXPECT_EQ(rig.state(), "introduction");
  rig.around.speech->finished = true;
  rig.wait(100);
  EXPECT_EQ(rig.state(), "location_ask");
  Rig mute;
  mute.around.speech = Speech{};
  mute.begin();
  mute.wait(8900);
  EXPECT_EQ(mute.state(), "introduction");
  mute.wait(200);
  EXPECT_EQ(mute.state(), "location_ask") << "whatever the voice says";
}

TEST(Guide, GreetsNobodyAnewWhoWasLostOnArrivalAndComesBackByAnotherIdentity) {
  for (const bool lost : {true, false}) {
    Rig rig;
    rig.meet(1), rig.wait(1100);
    ASSERT_EQ(rig.state(), "introduction");
    rig.to_end_ask();
    rig.around.supervisor = Supervisor::kAvailable;
    if (lost) rig.see_nobody(), rig.wait(5000);
    rig.press("no");
    ASSERT_EQ(rig.state(), "end");
    rig.wait(1000), rig.meet(13), rig.wait(60000);
    EXPECT_EQ(rig.guide.funnel().greeted, lost ? 1U : 2U) << "who came beside him is another";
  }
}

TEST(Guide, GreetsEverybodyOnce) {
  Rig rig;
  rig.meet(1), rig.wait(1100);
  ASSERT_EQ(rig.state(), "introduction");
  rig.wait(3000), rig.press("no"), rig.press("no"), rig.press("no");
  ASSERT_EQ(rig.state(), "end");
  rig.meet(2), rig.wait(4000);
  EXPECT_EQ(rig.state(), "inactive") << "for somebody else";
  rig.wait(100);
  EXPECT_EQ(rig.state(), "introduction");
  EXPECT_EQ(rig.guide.funnel().greeted, 2U);
  rig.wait(3000), rig.press("no"), rig.press("no"), rig.press("no");
  rig.meet(1), rig.wait(60000);
  EXPECT_EQ(rig.state(), "inactive");
  rig.wait(5000), rig.meet(2), rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive") << "each of them was greeted";
  rig.meet(3), rig.wait(500), rig.meet(4), rig.wait(700);
  EXPECT_EQ(rig.state(), "inactive") << "who passes by is not greeted";
  rig.see_nobody(), rig.wait(15100), rig.meet(1), rig.wait(1100);
  EXPECT_EQ(rig.state(), "introduction") << "he comes again";
}

TEST(Guide, PutsRecentPlacesFirst) {
  Rig rig;
  rig.to_options();
  rig.press("foyer"), rig.press("start");
  rig.around.supervisor = Supervisor::kNavigation;
  rig.wait(1000);
  rig.navigate(GoalState::kSucceeded);
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(4000);
  rig.press("yes"), rig.press("guide_me");
  EXPECT_EQ(rig.guide.screen().options[0].id, "foyer");
  EXPECT_EQ(rig.guide.screen().options[1].id, "am218");
}

TEST(Guide, FindsPlacesWhileTheirNamesAreTyped) {
  Rig rig;
  rig.to_options();
  rig.press("search");
  const auto id = rig.guide.screen().id;
  rig.type("fo");
  EXPECT_EQ(rig.guide.screen().id, id);
  EXPECT_TRUE(rig.offers("foyer"));
  EXPECT_FALSE(rig.offers("am218"));
  rig.type("qqqq");
  EXPECT_EQ(rig.guide.screen().text, "I do not know such a place.");
  rig.type(std::string(10000, 'x'));
  rig.type("co2399");
  EXPECT_TRUE(rig.offers("co239"));
  rig.press("co239");
  EXPECT_EQ(rig.state(), "guide_start");
}

TEST(Guide, PutsManyPlacesOnPages) {
  Rig rig;
  std::vector<Location> many;
  many.reserve(20);
  for (int i = 0; i < 20; ++i) many.push_back({"room" + std::to_string(i), "", {0, 0}});
  ASSERT_TRUE(rig.guide.set_locations(many, rig.now()).ok());
  rig.to_options();
  std::set<std::string> seen;
  for (int page = 0; page < 3; ++page) {
    std::size_t primary = 0;
    for (const Option& option : rig.guide.screen().options) {
      primary += option.panel == Panel::kPrimary ? 1 : 0;
      if (option.id.starts_with("room")) seen.insert(option.id);
    }
    EXPECT_LE(primary, 8U);
    const auto more =
        std::find_if(rig.guide.screen().options.begin(), rig.guide.screen().options.end(),
                     [](const Option& option) { return option.id == "more"; });
    EXPECT_EQ(more->label, page < 2 ? "More" : "First page") << page;
    rig.press("more");
  }
  EXPECT_EQ(seen.size(), 20U);
  EXPECT_EQ(rig.guide.screen().options[0].id, "room0") << "round again";
}

TEST(Guide, RefusesPlacesThatNoButtonCanName) {
  Guide guide({}, book(), 1, {}, {});
  const Status cancel = guide.set_locations({{"cancel", "Cancel", {0, 0}}}, Time(0));
  ASSERT_FALSE(cancel.ok());
  EXPECT_NE(cancel.error().find("'cancel'"), std::string::npos);
  EXPECT_FALSE(guide.set_locations({{"", "?", {0, 0}}}, Time(0)).ok());
  EXPECT_FALSE(guide.set_locations({{"language:en", "?", {0, 0}}}, Time(0)).ok());
  EXPECT_FALSE(guide.set_locations({{"a", "A", {0, 0}}, {"a", "B", {0, 0}}}, Time(0)).ok());
}

TEST(Guide, RepliesToEachOfTwoWhoAnswerInTheSameMoment) {
  Rig rig;
  rig.to_location_ask();
  const auto screen = rig.guide.screen().id;
  const Answer touch{screen, "guide_me", "", Input::kTouch, "tablet", 7};
  const Answer word{screen, "no", "", Input::kVoice, "speech", 3};
  rig.note(rig.guide.answer(touch, rig.now())), rig.note(rig.guide.answer(word, rig.now()));
  EXPECT_EQ(rig.guide.last_answer().client, "speech");
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kLate);
  rig.note(rig.guide.answer(touch, rig.now()));  // its reply was overwritten
  EXPECT_EQ(rig.guide.last_answer().client, "tablet");
  EXPECT_EQ(rig.guide.last_answer().id, 7U);
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kDone);
  EXPECT_EQ(rig.state(), "guide_options");
}

TEST(Guide, LeavesTimeToFindTheLanguage) {
  Rig rig(Parameters{});
  rig.begin(), rig.wait(5900);
  EXPECT_EQ(rig.state(), "introduction");
  rig.wait(100);
  EXPECT_EQ(rig.state(), "location_ask");
}

TEST(Guide, AsksWhatWasThoughtOfTheVisitAndKeepsTheAnswers) {
  Parameters asks = quick();
  asks.questionnaire = true;
  Rig rig(asks);
  rig.to_feedback();
  EXPECT_EQ(rig.guide.screen().title, "MARVIN's voice was easy to understand.");
  EXPECT_EQ(rig.guide.screen().text, "Do you agree? Statement 1 of 13.");
  rig.press("rating:4");
  const auto late = rig.guide.screen().id;
  rig.press("skip");
  rig.guide.answer({late, "rating:1", "", Input::kTouch}, rig.now());
  EXPECT_EQ(rig.guide.last_result(), AnswerResult::kLate) << "one touch, one statement";
  const auto memory = memory_from_text(to_text(rig.guide.memory()));
  ASSERT_TRUE(memory.ok()) << memory.error();
  Rig again(asks, *memory, 1000000);
  EXPECT_EQ(again.guide.screen().title, "The touch interface text was large enough to read.");
  again.speak_and_move(), again.wait(100);
  for (int i = 0; i < 11; ++i) again.press("rating:" + std::to_string(i % 5 + 1));
  EXPECT_EQ(again.state(), "end");
  EXPECT_EQ(again.guide.screen().text, "Thank you for your answers.");
  ASSERT_EQ(again.visits.size(), 1U);
  EXPECT_EQ(again.visits[0].ratings,
            (std::vector<std::uint8_t>{4, 0, 1, 2, 3, 4, 5, 1, 2, 3, 4, 5, 1}));
  Rig silent;
  silent.to_feedback();
  EXPECT_EQ(silent.state(), "end") << "only where the site wants it";
  Rig nowhere(asks);
  nowhere.to_options(), nowhere.press("cancel"), nowhere.press("no");
  EXPECT_EQ(nowhere.state(), "end") << "only of a visit that arrived";
}

TEST(Guide, AsksNothingAboutAVoiceOrABodyThatIsNotThere) {
  Parameters asks = quick();
  asks.questionnaire = true;
  Rig rig(asks);
  rig.to_end_ask(), rig.press("no");
  EXPECT_EQ(rig.guide.screen().title, "The touch interface text was large enough to read.");
  EXPECT_EQ(rig.guide.screen().text, "Do you agree? Statement 1 of 8.");
  for (int i = 0; i < 3; ++i) rig.press("rating:2");
  EXPECT_EQ(rig.guide.screen().title, "Requesting my location was easy.");
  for (int i = 0; i < 4; ++i) rig.press("rating:3");
  EXPECT_EQ(rig.guide.screen().text, "Do you agree? Statement 8 of 8.");
  rig.press("rating:4");
  EXPECT_EQ(rig.state(), "end");
  ASSERT_EQ(rig.visits.size(), 1U);
  EXPECT_EQ(rig.visits[0].ratings,
            (std::vector<std::uint8_t>{0, 0, 2, 2, 2, 0, 0, 3, 3, 3, 3, 4, 0}));
  Rig deaf(asks);
  deaf.to_end_ask(), deaf.speak_and_move();
  deaf.around.speech->understands = false;
  deaf.wait(100), deaf.press("no");
  EXPECT_EQ(deaf.guide.screen().text, "Do you agree? Statement 1 of 11.");
}

TEST(Guide, NamesPlacesInTheVisitorsLanguage) {
  Rig rig;
  ASSERT_TRUE(
      rig.guide.set_locations({{"kitchen", "Kitchen", {1, 0}, {{"de", "Küche"}}}}, rig.now()).ok());
  rig.press("language:de"), rig.wait(3000), rig.press("guide_me");
  ASSERT_FALSE(rig.guide.screen().options.empty());
  EXPECT_EQ(rig.guide.screen().options[0].label, "Küche");
  rig.press("kitchen");
  EXPECT_EQ(rig.guide.screen().title, "Ihr Ziel: Küche.");
}

TEST(Guide, RefusesRatingsThatAreNone) {
  const std::string good = to_text(Memory{});
  for (const char* bad : {"6", "12345012345012", "a"}) {
    EXPECT_FALSE(memory_from_text(good + "ratings " + bad + "\n").ok()) << bad;
  }
}

// Whatever visitor, navigator and supervisor do: option ids are unique, the screen's id never goes
// back, what is said is short, and a robot left alone comes to rest, also one that does not get
// well: it says why.
TEST(Guide, HasNoDeadEnd) {
  Random random(11);
  Parameters asks = quick();
  asks.questionnaire = true;
  std::set<std::string> labels{"AM218", "CO239", "Foyer"};
  const auto texts = book();
  for (std::size_t language = 0; language < texts.languages().size(); ++language) {
    labels.insert(texts.languages()[language].name);
    for (std::size_t text = 0; text < kTextKeys.size(); ++text) {
      if (labels_button(static_cast<Text>(text))) labels.insert(texts.phrase(language, text));
    }
  }
  for (int run = 0; run < 300; ++run) {
    Rig rig(asks);
    std::uint64_t last_id = 0;
    for (int i = 0; i < 200; ++i) {
      const auto options = rig.guide.screen().options;
      if (random.below(2) == 0 && !options.empty()) {
        rig.press(options[random.below(options.size())].id);
      }
      rig.around.supervisor = static_cast<Supervisor>(random.below(20) == 0  ? random.below(7)
                                                      : random.below(3) == 0 ? 4
                                                                             : 3);
      if (random.below(3) == 0) rig.see(random.uniform(-6.0, 3.0), random.uniform(0.0, 2.0));
      if (random.below(4) == 0) rig.see_nobody();
      if (rig.around.visitor) rig.around.visitor->person = random.below(4);
      if (random.below(9) == 0) rig.around.visitor.reset();
      rig.around.permission = static_cast<Permission>(random.below(9) == 0 ? random.below(3) : 0);
      rig.around.speech.reset();
      if (random.below(2) == 0)
        rig.around.speech = Speech{rig.guide.screen().spoken_id, random.below(2) == 0};
      if (random.below(4) == 0) {
        rig.around.navigation = Navigation{
            rig.goal - random.below(2), static_cast<GoalState>(random.below(7)),    0.3, 4.0, 8.0,
            random.below(2) == 0,       static_cast<std::uint32_t>(random.below(3))};
      }
      if (random.below(30) == 0) rig.around.navigation.reset();
      if (random.below(40) == 0) {  // a restart
        const Memory memory = rig.guide.memory();
        const auto read = memory_from_text(to_text(memory));
        ASSERT_TRUE(read.ok()) << read.error();
        Guide again(asks, book({"en", "de"}), rig.guide.screen().id + 100, *read, rig.now());
        rig.guide = std::move(again);
        ASSERT_TRUE(rig.guide.set_locations(rooms(), rig.now()).ok());
      }
      rig.wait(static_cast<int>(random.below(3000)));
      const Screen& screen = rig.guide.screen();
      ASSERT_GE(screen.id, last_id);
      ASSERT_FALSE(screen.title.empty());
      std::set<std::string> ids;
      for (const Option& option : screen.options) {
        ASSERT_TRUE(ids.insert(option.id).second) << option.id << " in " << screen.state;
        ASSERT_TRUE(option.takes_text || labels.count(option.label) > 0) << option.label;
      }
      last_id = screen.id;
    }
    const bool stays_unwell = run % 2 == 1;  // as it is now
    if (!stays_unwell) {
      rig.around.supervisor = Supervisor::kAvailable;
      rig.around.permission = Permission::kGiven;
      rig.around.navigation = Navigation{};
    }
    rig.see_nobody();
    rig.wait(400000);
    ASSERT_FALSE(rig.guide.serves()) << "run " << run;
    const Supervisor supervisor = rig.around.supervisor;
    if (supervisor == Supervisor::kAvailable) {
      ASSERT_EQ(rig.guide.state(), State::kInactive) << "run " << run;
      continue;
    }
    // It waits, offers nothing and says why.
    const Text why = supervisor == Supervisor::kManual ? Text::kOperatorDrives : Text::kNotReady;
    ASSERT_EQ(rig.guide.state(), State::kInitialise) << "run " << run;
    ASSERT_TRUE(rig.guide.screen().options.empty()) << "run " << run;
    ASSERT_EQ(rig.guide.screen().text, texts.phrase(0, static_cast<std::size_t>(why)))
        << "run " << run;
    rig.around.supervisor = Supervisor::kAvailable;
    rig.wait(1000);
    ASSERT_EQ(rig.guide.state(), State::kInactive) << "run " << run;
  }
}

}  // namespace
}  // namespace usher::guide
