#include "tasks/guide/core/guide.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <sstream>

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
  EXPECT_EQ(rig.guide.screen().text, "We are at CO239.") << "the nearest place";
  rig.around.pose->y = 3.0, rig.wait(100);
  EXPECT_EQ(rig.guide.screen().text, "We are near CO239.");
  rig.press("done");
  EXPECT_EQ(rig.guide.screen().title, "Would you like me to guide you somewhere?");
  rig.press("yes");
  EXPECT_EQ(rig.guide.screen().title, "Where would you like to go?");
  EXPECT_EQ(rig.guide.screen().options[0], (Option{"am218", "AM218"}));
  rig.press("am218");
  EXPECT_EQ(rig.guide.screen().title, "I will take you to AM218.");
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

TEST(Guide, TakesAStopHoweverLateItsScreenIs) {
  Rig rig;
  rig.to_active();
  rig.note(rig.guide.answer({1, "stop"}, rig.now()));
  EXPECT_EQ(rig.state(), "guide_paused");
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

TEST(Guide, TellsTimeAndWayAtTheStartAndAtTheEnd) {
  Rig rig;
  rig.to_active();
  for (int i = 0; i <= 40; ++i) {
    rig.around.navigation->remaining = 40.0 - i;
    rig.around.navigation->eta = (40.0 - i) * 1.5;
    rig.around.navigation->progress = i / 40.0;
    rig.wait(1000);
  }
  std::string all;
  for (const auto& sentence : rig.said) all += sentence + "|";
  EXPECT_NE(all.find("It is 40 metres, about one minute."), std::string::npos) << all;
  EXPECT_NE(all.find("We are almost there."), std::string::npos) << all;
  EXPECT_EQ(all.find("It is"), all.rfind("It is")) << "said once: " << all;
  rig.navigate(GoalState::kSucceeded);
  EXPECT_NEAR(rig.guide.visit().eta_error, 41.0 / 60.0 - 1.0, 0.05);
}

TEST(Guide, CountsMetresAsPeopleDo) {
  Rig rig;
  rig.to_active();
  rig.around.navigation->eta = 3.0;
  for (const auto& [way, words] :
       {std::pair{17.4, "It is 17 metres,"}, std::pair{1.2, "It is one metre,"}}) {
    rig.around.navigation->remaining = way;
    rig.wait(5000);
    EXPECT_TRUE(rig.guide.screen().text.starts_with(words)) << rig.guide.screen().text;
  }
}

TEST(Guide, ShowsProgressUnderTheSameScreenAndNotTooOften) {
  Rig rig;
  rig.to_active();
  const std::uint64_t id = rig.guide.screen().id;
  int updates = 0;
  for (int i = 0; i < 100; ++i) {
    rig.now_ms += 100;
    rig.around.navigation->progress = 0.01 * i;
    rig.around.navigation->remaining = 100.0 - i;
    rig.around.navigation->eta = 30.0 - 0.1 * i;
    updates += rig.guide.step(rig.around, rig.now()).screen_changed ? 1 : 0;
  }
  EXPECT_EQ(rig.guide.screen().id, id);
  EXPECT_GT(rig.guide.screen().progress, 0.85);
  EXPECT_LT(rig.guide.screen().eta, 22.0);
  EXPECT_LE(updates, 13);
  rig.around.navigation->progress = std::nan("");
  rig.around.navigation->eta = -1.0;
  rig.wait(2000);
  EXPECT_EQ(rig.guide.screen().progress, 0.0);
  EXPECT_TRUE(std::isnan(rig.guide.screen().eta));
}

TEST(Guide, AsksToBeLetThroughThenTellsOfAnotherWay) {
  Rig rig;
  rig.to_active();
  rig.around.navigation->blocked = true;
  rig.wait(2900);
  EXPECT_NE(rig.said.back(), "Excuse me, may I pass?");
  rig.wait(300);
  EXPECT_EQ(rig.said.back(), "Excuse me, may I pass?");
  EXPECT_EQ(rig.guide.screen().tone, Tone::kPlease);
  const auto said = rig.said.size();
  rig.wait(7000);
  EXPECT_EQ(rig.said.size(), said) << "does not nag";
  rig.wait(1500);
  EXPECT_EQ(rig.said.size(), said + 1) << "asks again";
  rig.around.navigation->replans = 1;
  rig.wait(100);
  EXPECT_EQ(rig.said.back(), "I am looking for another way.");
}

TEST(Guide, FitsThePaceWaitsCallsAndGoesOn) {
  Rig rig;
  rig.see(1.2);
  rig.to_active();
  rig.see(-1.5);
  rig.wait(200);
  EXPECT_DOUBLE_EQ(rig.pace, 1.15);
  EXPECT_EQ(rig.guide.screen().follower, Follower::kFollowing);
  rig.see(-3.0);
  rig.wait(200);
  EXPECT_EQ(rig.guide.screen().follower, Follower::kLagging);
  EXPECT_LT(rig.pace, 1.0);
  rig.see(-4.1);
  rig.wait(200);
  EXPECT_EQ(rig.taken(), "stop");
  EXPECT_EQ(rig.said.back(), "I am waiting for you.");
  EXPECT_EQ(rig.state(), "guide_active");
  rig.wait(5000);
  EXPECT_EQ(rig.said.back(), "Are you there? I am waiting for you.");
  rig.see(-2.0);
  rig.wait(200);
  EXPECT_EQ(rig.said.back(), "Here we go.");
  EXPECT_EQ(rig.guide.screen().tone, Tone::kMoving);
  EXPECT_EQ(rig.taken(), "") << "a tone before the first motion";
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on");
  EXPECT_EQ(rig.guide.visit().waits, 1U);
}

TEST(Guide, WhoWalksAheadDoesNotFallBehind) {
  Rig rig;
  rig.see(-1.0), rig.to_active();
  for (const double ahead : {2.5, 4.0, 5.5}) {
    rig.see(ahead), rig.wait(70000);
    EXPECT_EQ(rig.taken(), "") << ahead;
    EXPECT_DOUBLE_EQ(rig.pace, 1.15) << ahead;
    EXPECT_EQ(rig.state(), "guide_active");
  }
  rig.see(6.5), rig.wait(200);
  EXPECT_EQ(rig.taken(), "stop") << "he has gone";
  rig.see(4.5), rig.wait(1200);
  EXPECT_EQ(rig.taken(), "") << "he may be walking away";
  rig.see(1.5), rig.wait(1200);
  EXPECT_EQ(rig.taken(), "on");
  EXPECT_LT(rig.guide.visit().largest_gap, 2.0);
}

TEST(Guide, GoesOnWaitingWhenNobodyLooksAnyMore) {
  Rig rig;
  rig.see(1.2), rig.to_active();
  rig.see(-4.1), rig.wait(200);
  ASSERT_EQ(rig.taken(), "stop");
  rig.around.visitor.reset();
  rig.wait(30000);
  EXPECT_EQ(rig.taken(), "") << "who was missing is missing still";
  ASSERT_TRUE(rig.offers("stay"));
  rig.press("stay"), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on") << "he says that he is there";
}

TEST(Guide, CountsTheAnswerThatEndsTheVisit) {
  Rig rig;
  rig.to_location_ask();
  rig.press("no");
  rig.press("no");
  rig.press("no");
  ASSERT_EQ(rig.visits.size(), 1U) << rig.state();
  EXPECT_EQ(rig.visits[0].touches, 4U);
}

TEST(Guide, GoesOnWithAVisitorWhomItDoesNotSeeButWhoSaysThatHeIsThere) {
  Rig rig;
  rig.see(-1.0), rig.to_active();
  EXPECT_FALSE(rig.offers("stay"));
  rig.around.pose->x += 0.6, rig.wait(100);
  rig.see_nobody(), rig.wait(1200);
  EXPECT_EQ(rig.taken(), "stop");
  ASSERT_TRUE(rig.offers("stay"));
  rig.press("stay");
  EXPECT_EQ(rig.guide.screen().tone, Tone::kMoving);
  EXPECT_EQ(rig.guide.screen().text, "Here we go.");
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on");
  EXPECT_FALSE(rig.offers("stay"));
  rig.wait(5000);
  EXPECT_EQ(rig.taken(), "") << "he has time to step behind";
  rig.wait(4000);
  EXPECT_EQ(rig.taken(), "stop") << "but nobody does";
}

TEST(Guide, GivesUpAVisitorWhoDoesNotComeBack) {
  Rig rig;
  rig.see(1.2);
  rig.to_active();
  rig.see(-5.0);
  rig.wait(61000);
  EXPECT_EQ(rig.state(), "end");
  EXPECT_EQ(rig.guide.screen().title, "I have lost you, so I stop here.");
  ASSERT_EQ(rig.visits.size(), 1U);
  EXPECT_EQ(rig.visits[0].outcome, Outcome::kGivenUp);
  EXPECT_EQ(rig.guide.funnel().given_up, 1U);
}

TEST(Guide, WaitsForNobodyWhileNobodyLooks) {
  Rig rig;
  rig.to_active();
  rig.wait(100000);
  EXPECT_EQ(rig.state(), "guide_active");
  EXPECT_EQ(rig.taken(), "");
  EXPECT_EQ(rig.guide.screen().follower, Follower::kUnknown);
  EXPECT_LT(rig.pace, 0.0) << "no pace but the goal's";
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

TEST(Guide, SaysWhetherItServesAndGuides) {
  Rig rig;
  EXPECT_FALSE(rig.guide.serves());
  rig.begin();
  EXPECT_TRUE(rig.guide.serves());
  EXPECT_FALSE(rig.guide.guides());
  Rig way;
  way.to_active();
  EXPECT_TRUE(way.guide.serves() && way.guide.guides());
  way.press("stop");
  EXPECT_TRUE(way.guide.guides()) << "a stop on the way";
  way.press("cancel");
  EXPECT_TRUE(way.guide.serves());
  EXPECT_FALSE(way.guide.guides());
  way.press("no");
  EXPECT_FALSE(way.guide.serves()) << way.state();
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

TEST(Guide, GivesTheGoalAgainToANavigatorThatForgotIt) {
  Rig rig;
  rig.to_active();
  const auto goal = rig.goal;
  for (int restart = 0; restart < 3; ++restart) {
    rig.around.navigation = Navigation{};
    rig.wait(100);
    EXPECT_EQ(rig.taken(), "goal:am218");
    EXPECT_EQ(rig.goal, goal) << "the same goal";
    rig.navigate(GoalState::kActive);
  }
  rig.around.navigation = Navigation{};
  rig.wait(100);
  EXPECT_EQ(rig.state(), "guide_error") << "not for ever";
}

TEST(Guide, ARefusedForeignGoalDoesNotEndTheVisit) {
  Rig rig;
  rig.to_active();
  const auto foreign = [&](GoalState state) {
    rig.around.navigation->goal_id = 99;
    rig.around.navigation->state = state;
    rig.wait(200);
  };
  for (const auto refused : {GoalState::kFailed, GoalState::kReplaced}) {
    foreign(refused);
    EXPECT_EQ(rig.state(), "guide_active");
    rig.navigate(GoalState::kActive);
  }
  EXPECT_EQ(rig.taken(), "");
  foreign(GoalState::kActive);
  EXPECT_EQ(rig.state(), "guide_error") << "one that runs has taken its place";
}

TEST(Guide, StartsTheNavigationAgainAtASupervisorThatForgotIt) {
  Rig rig;
  rig.to_active();
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(5000);
  EXPECT_EQ(rig.taken(), "stop start:am218 go");
  rig.around.supervisor = Supervisor::kNavigation;
  rig.wait(100);
  EXPECT_EQ(rig.state(), "guide_active");
  EXPECT_EQ(rig.toned_ms, rig.now_ms);
  EXPECT_EQ(rig.taken(), "") << "a tone before the first motion";
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on");
}

TEST(Guide, FailsWhenTheRobotDoesNotAnswerForLong) {
  Rig rig;
  rig.to_active();
  rig.around.supervisor = Supervisor::kUnknown;
  rig.wait(2000);
  EXPECT_EQ(rig.guide.screen().text, "One moment, please. I have to wait for a part of me.");
  rig.wait(58500);
  EXPECT_EQ(rig.state(), "guide_error");
  Rig silent;
  silent.to_active();
  silent.around.navigation.reset();
  silent.wait(5200);
  EXPECT_EQ(silent.state(), "guide_error");
  EXPECT_EQ(silent.taken(), "end cancel");
  Rig refused;
  refused.to_start();
  refused.note(refused.guide.refused(refused.now()));
  EXPECT_EQ(refused.state(), "guide_error");
}

TEST(Guide, SaysThatSomebodyElseHasStoppedItAndGivesUpInTheEnd) {
  Rig rig;
  rig.to_active();
  rig.around.navigation->remaining = 20.0, rig.around.navigation->eta = 20.0;
  rig.wait(5000);
  EXPECT_EQ(rig.guide.screen().status, "Driving");
  rig.around.permission = Permission::kStopped;
  rig.navigate(GoalState::kWaiting);
  EXPECT_EQ(rig.guide.screen().status, "Standing");
  rig.wait(6000);
  EXPECT_EQ(rig.guide.screen().text, "Somebody has stopped me.");
  EXPECT_EQ(rig.said.back(), "Somebody has stopped me.");
  rig.wait(80000);
  EXPECT_EQ(rig.state(), "guide_active") << "as long as a stop of the visitor";
  rig.around.permission = Permission::kGiven;
  rig.navigate(GoalState::kActive);
  EXPECT_EQ(rig.said.back(), "Here we go.");
  EXPECT_EQ(rig.guide.screen().tone, Tone::kMoving);
  EXPECT_EQ(rig.taken(), "stop") << "so that it does not drive off with the tone";
  EXPECT_EQ(rig.guide.screen().status, "Standing");
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on");
  EXPECT_EQ(rig.guide.screen().status, "Driving");
  rig.around.permission = Permission::kStopped;
  rig.wait(120100);
  EXPECT_EQ(rig.state(), "guide_error");
  EXPECT_TRUE(rig.guide.screen().text.starts_with("Somebody has stopped me."));
  EXPECT_EQ(rig.taken(), "stop end on cancel");
}

TEST(Guide, AStopOfTheVisitorIsNotCutShortByAnotherOne) {
  Rig rig;
  rig.to_active();
  rig.press("stop");
  rig.around.permission = Permission::kStopped;
  rig.wait(100000), rig.press("stay"), rig.wait(100000);
  EXPECT_EQ(rig.state(), "guide_paused");
}

TEST(Guide, SaysWhyItMayNotMove) {
  Rig rig;
  rig.to_active();
  rig.around.permission = Permission::kRefused;
  rig.wait(1100);
  EXPECT_EQ(rig.guide.screen().text, "One moment, please. I have to wait for a part of me.");
  EXPECT_EQ(rig.guide.screen().status, "Standing");
  rig.around.permission = Permission::kGiven;
  rig.around.pose.reset();
  rig.navigate(GoalState::kWaiting);
  EXPECT_EQ(rig.guide.screen().status, "Standing");
  rig.wait(1100);
  EXPECT_EQ(rig.guide.screen().text, "I am not sure where we are.");
  rig.around.pose = geometry::Pose2{};
  rig.navigate(GoalState::kActive);
  EXPECT_EQ(rig.guide.screen().text, "Here we go.");
  Rig leads;
  leads.to_following();
  leads.around.permission = Permission::kStopped;
  leads.wait(1100);
  EXPECT_EQ(leads.guide.screen().text, "Somebody has stopped me.");
  leads.around.permission = Permission::kGiven;
  leads.wait(100);
  EXPECT_EQ(leads.guide.screen().text, "Walk ahead. Choose Done when we are there.");
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

TEST(Guide, AVisitorWhoCameBackOnTheWayIsNotGreetedAgain) {
  Rig rig;
  rig.meet(1), rig.wait(1100), rig.wait(3000);
  rig.press("guide_me"), rig.press("am218"), rig.press("start");
  rig.around.supervisor = Supervisor::kNavigation;
  rig.wait(1000), rig.navigate(GoalState::kActive);
  rig.see_nobody(), rig.wait(20000);
  rig.meet(1), rig.wait(1000);
  rig.navigate(GoalState::kSucceeded);
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(4000), rig.press("no"), rig.wait(60000);
  ASSERT_EQ(rig.state(), "inactive");
  rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive");
}

TEST(Guide, AVisitorWhoseIdentityChangedOnTheWayIsNotGreetedAgain) {
  Rig rig;
  rig.meet(1), rig.to_active();
  rig.meet(7), rig.wait(1000);
  rig.navigate(GoalState::kSucceeded);
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(4000), rig.press("no"), rig.wait(60000);
  ASSERT_EQ(rig.state(), "inactive");
  rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive");
  rig.meet(1), rig.wait(5000);
  EXPECT_EQ(rig.state(), "inactive");
}

TEST(Guide, GoesOnAfterItsOwnRestart) {
  Rig before;
  before.press("language:de");
  before.wait(3000);
  before.press("guide_me");
  {
    Rig after(quick(), before.guide.memory(), 1000000);
    EXPECT_EQ(after.state(), "guide_options");
    EXPECT_EQ(after.guide.screen().title, "Wohin möchten Sie?");
    EXPECT_GT(after.guide.screen().id, before.guide.screen().id);
  }
  before.press("am218"), before.press("start");
  before.around.supervisor = Supervisor::kNavigation;
  before.wait(1000);
  before.navigate(GoalState::kActive);
  Rig after(quick(), before.guide.memory(), 1000000);
  EXPECT_EQ(after.state(), "guide_active");
  EXPECT_EQ(after.guide.screen().title, "Wir sind unterwegs. Ziel: AM218.");
  after.goal = before.goal;
  after.around.supervisor = Supervisor::kNavigation;
  after.navigate(GoalState::kSucceeded);
  EXPECT_EQ(after.state(), "guide_success");
  EXPECT_EQ(after.guide.funnel().arrived, 1U);
  EXPECT_EQ(after.guide.visit().touches, 4U) << "the visit is the same one";
}

TEST(Guide, StaysStoppedAfterItsOwnRestart) {
  Rig before;
  before.to_start(), before.press("start"), before.wait(500), before.press("stop");
  ASSERT_EQ(before.taken(), "start:am218 go stop") << "stopped before the first motion";
  Rig paused(quick(), before.guide.memory(), 1000000);
  paused.around.supervisor = Supervisor::kNavigation;
  paused.wait(10000);
  EXPECT_EQ(paused.state(), "guide_paused");
  EXPECT_EQ(paused.taken(), "");
  paused.press("continue"), paused.wait(1000);
  EXPECT_EQ(paused.taken(), "on goal:am218");
  Rig starting;
  starting.to_start(), starting.press("start"), starting.wait(500);
  const Guide restarted({}, book(), 1000000, starting.guide.memory(), {});
  EXPECT_EQ(restarted.screen().tone, Tone::kMoving) << "it has not set off yet";

  Rig waits;
  waits.see(-1.0), waits.to_active(), waits.see(-5.0), waits.wait(100);
  ASSERT_EQ(waits.taken(), "stop");
  Rig again(quick(), waits.guide.memory(), 1000000);
  again.around.supervisor = Supervisor::kNavigation;
  again.goal = waits.goal;
  again.navigate(GoalState::kWaiting);
  EXPECT_EQ(again.taken(), "goal:am218") << "to a navigator that forgot it, too";
  again.wait(10000);
  EXPECT_EQ(again.taken(), "") << "nobody is there";
  EXPECT_TRUE(again.offers("stay"));
  again.see(-1.0), again.wait(1200);
  EXPECT_EQ(again.taken(), "on");
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

TEST(Guide, TurnsToTheVisitorOnArrival) {
  Rig rig;
  rig.see(-1.5), rig.to_active();
  EXPECT_FALSE(rig.guide.turns_to());
  rig.navigate(GoalState::kSucceeded);
  EXPECT_EQ(rig.toned_ms, rig.now_ms);
  EXPECT_EQ(rig.guide.screen().spoken, "We have arrived. This is AM218.") << "with the tone";
  rig.see_at(-1.0, 1.0, 0.0), rig.wait(900);
  EXPECT_FALSE(rig.guide.turns_to());
  rig.wait(100);
  ASSERT_TRUE(rig.guide.turns_to());
  EXPECT_NEAR(*rig.guide.turns_to(), 2.356, 1e-3);
  rig.see_nobody(), rig.wait(100);
  EXPECT_FALSE(rig.guide.turns_to()) << "nobody is there to face";
  rig.see(-1.0), rig.wait(4000);
  EXPECT_EQ(rig.state(), "end_ask");
  EXPECT_TRUE(rig.guide.turns_to());
  rig.see(1.2), rig.wait(100);
  EXPECT_FALSE(rig.guide.turns_to()) << "it faces him";
  rig.see(-1.0), rig.wait(100);
  EXPECT_FALSE(rig.guide.turns_to()) << "and does not turn after him";
}

TEST(Guide, AStopOnArrivalHoldsUntilHeGoesOnOrLeaves) {
  Rig rig;
  rig.see(-1.5), rig.to_active(), rig.press("stop");
  EXPECT_EQ(rig.taken(), "stop");
  rig.navigate(GoalState::kSucceeded), rig.wait(2000);
  ASSERT_EQ(rig.state(), "guide_success");
  EXPECT_FALSE(rig.guide.turns_to()) << "somebody's foot is in the way";
  EXPECT_EQ(rig.taken(), "end") << "the stop holds";
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(4000), rig.press("yes"), rig.press("guide_me"), rig.press("foyer"), rig.press("start");
  rig.around.supervisor = Supervisor::kNavigation;
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "start:foyer go on goal:foyer");
  rig.press("stop"), rig.press("cancel");
  EXPECT_EQ(rig.taken(), "stop end cancel");
  rig.press("yes"), rig.press("no"), rig.press("languages");
  Rig after(quick(), rig.guide.memory(), 1000000);
  EXPECT_EQ(after.state(), "inactive");
  EXPECT_EQ(after.taken(), "on") << "nobody is served any more";
  Rig leads;
  leads.see(1.2), leads.to_active(), leads.press("stop"), leads.press("cancel");
  leads.around.supervisor = Supervisor::kAvailable;
  leads.press("yes"), leads.press("no"), leads.taken();
  leads.press("follow_me"), leads.wait(1000);
  EXPECT_EQ(leads.taken(), "start:visitor go on");
}

TEST(Guide, StopsAgainWhenAnOperatorEndsTheStopThatItNeeds) {
  Rig rig;
  rig.to_active(), rig.press("stop");
  EXPECT_EQ(rig.taken(), "stop");
  rig.around.stop_holds = true, rig.wait(1000);
  EXPECT_EQ(rig.taken(), "");
  rig.around.stop_holds = false, rig.wait(100);
  EXPECT_EQ(rig.taken(), "stop") << "the visitor has not gone on";
  rig.around.stop_holds = std::nullopt, rig.wait(1000);
  EXPECT_EQ(rig.taken(), "") << "that is not answered yet";
}

TEST(Guide, LiftsAStopThatABootHasMadeItForget) {
  Rig rig;
  rig.around.stop_holds = true, rig.wait(100);
  EXPECT_EQ(rig.taken(), "on");
}

TEST(Guide, EndsAJourneyThatItHasForgottenBeforeItLiftsItsStop) {
  Rig rig;
  rig.goal = 7;
  rig.around.supervisor = Supervisor::kNavigation;
  rig.around.stop_holds = true;
  rig.around.navigation->ours = true;
  rig.navigate(GoalState::kWaiting), rig.wait(100);
  EXPECT_EQ(rig.taken(), "end cancel") << "the supervisor navigates: it would drive off";
  rig.around.stop_holds.reset();
  rig.navigate(GoalState::kCancelled), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "");
  rig.around.supervisor = Supervisor::kAvailable;
  rig.around.stop_holds = true;
  rig.see_nobody(), rig.wait(100);
  EXPECT_EQ(rig.taken(), "on");
  rig.around.stop_holds = false;
  rig.wait(60000);
  EXPECT_FALSE(rig.guide.seeks()) << "who stopped it may lie before it";
}

TEST(Guide, EndsAJourneyThatItHasForgottenThoughNothingHoldsIt) {
  Rig rig;
  rig.goal = 7;
  rig.around.supervisor = Supervisor::kNavigation;
  rig.around.stop_holds = false;
  rig.navigate(GoalState::kActive);
  EXPECT_EQ(rig.taken(), "") << "somebody else's way";
  rig.around.navigation->ours = true;
  rig.wait(100);
  EXPECT_EQ(rig.taken(), "end cancel");
}

TEST(Guide, AStopInAFollowingHoldsUntilHeGoesOnOrLeaves) {
  Rig rig;
  rig.to_following(), rig.wait(1000), rig.taken();
  rig.press("stop");
  ASSERT_EQ(rig.state(), "end_ask");
  EXPECT_EQ(rig.taken(), "stop end");
  rig.around.supervisor = Supervisor::kAvailable;
  rig.around.stop_holds = true;
  rig.wait(2000);
  EXPECT_EQ(rig.taken(), "") << "it holds";
  rig.press("yes"), rig.press("no"), rig.press("follow_me"), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "start:visitor go on");
  rig.around.stop_holds.reset();
  rig.press("stop"), rig.taken();
  rig.press("no");
  ASSERT_EQ(rig.state(), "end");
  EXPECT_EQ(rig.taken(), "on") << "the next visitor finds a robot that can go";
  Rig done;
  done.to_following(), done.wait(1000), done.taken();
  done.press("done");
  EXPECT_EQ(done.taken(), "end") << "that is no stop";
}

TEST(Guide, AGoalThatEndsInAPauseIsGivenAgain) {
  Rig rig;
  rig.to_active(), rig.press("stop");
  rig.navigate(GoalState::kFailed), rig.wait(2000);
  EXPECT_EQ(rig.state(), "guide_paused") << "the visitor has more patience than the navigator";
  EXPECT_EQ(rig.taken(), "stop");
  rig.press("continue"), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on goal:am218");
}

TEST(Guide, SaysThatItIsLostWhenItsGoalFailsWithoutAPose) {
  Rig rig;
  rig.to_active();
  rig.around.pose.reset();
  rig.navigate(GoalState::kFailed);
  ASSERT_EQ(rig.state(), "guide_error");
  EXPECT_NE(rig.guide.screen().text.find("not sure where we are"), std::string::npos)
      << rig.guide.screen().text;
}

TEST(Guide, AsksAgainAfterARestart) {
  Rig rig;
  rig.to_location_ask();
  Rig after(quick(), rig.guide.memory(), 1000000);
  ASSERT_FALSE(after.said.empty());
  EXPECT_EQ(after.said.front(), "Would you like to see our location?");
}

TEST(Guide, AsksToBeLetThroughWhileItFollows) {
  Rig rig;
  rig.to_following(), rig.see(3.0), rig.wait(2000);
  ASSERT_NE(rig.goal, 0U);
  rig.navigate(GoalState::kActive);
  rig.around.navigation->blocked = true;
  const auto count = rig.said.size();
  rig.wait(4000);
  ASSERT_GT(rig.said.size(), count);
  EXPECT_EQ(rig.said.back(), "Excuse me, may I pass?");
  rig.around.navigation->replans = 3;
  rig.around.navigation->blocked = false, rig.wait(200);
  EXPECT_NE(rig.said.back(), "I am looking for another way.");
}

TEST(Guide, AStopThatNobodyAnswersLeavesTheRobotAsItStands) {
  Rig rig;
  rig.see(-1.5), rig.to_active(), rig.press("stop");
  rig.see_nobody(), rig.wait(120000);
  ASSERT_EQ(rig.state(), "end");
  EXPECT_EQ(rig.taken(), "stop end on cancel") << "the next visitor finds a robot that can go";
  rig.around.supervisor = Supervisor::kAvailable;
  rig.wait(60000);
  ASSERT_EQ(rig.state(), "inactive");
  EXPECT_FALSE(rig.guide.seeks()) << "who stopped it may lie before it";
  Rig after(quick(), rig.guide.memory(), 1000000);
  after.see_nobody(), after.wait(60000);
  ASSERT_EQ(after.state(), "inactive");
  EXPECT_FALSE(after.guide.seeks()) << "over a restart, too";
  rig.see(1.5), rig.wait(1200);
  ASSERT_EQ(rig.state(), "introduction");
  rig.see_nobody(), rig.wait(60000);
  ASSERT_EQ(rig.state(), "inactive");
  EXPECT_TRUE(rig.guide.seeks()) << "another one was greeted by a robot that stood";

  Rig tablet;
  tablet.to_location_ask();
  tablet.around.permission = Permission::kStopped;
  tablet.see_nobody(), tablet.wait(16000);
  ASSERT_EQ(tablet.state(), "end");
  tablet.around.permission =
      Permission::kGiven;  // the end of the visit lifts the tablet's own stop
  tablet.wait(60000);
  ASSERT_EQ(tablet.state(), "inactive");
  EXPECT_FALSE(tablet.guide.seeks());
  tablet.to_location_ask(), tablet.press("no"), tablet.press("no"), tablet.press("no");
  tablet.wait(60000);
  ASSERT_EQ(tablet.state(), "inactive");
  EXPECT_TRUE(tablet.guide.seeks()) << "somebody has touched it since";

  Rig bye;
  bye.to_active(), bye.press("stop"), bye.press("cancel"), bye.press("no");
  bye.around.supervisor = Supervisor::kAvailable;
  bye.see_nobody(), bye.wait(60000);
  EXPECT_TRUE(bye.guide.seeks()) << "he said goodbye";

  Rig restarted(
      quick(),
      [] {
        Rig before;
        before.to_active(), before.press("stop"), before.press("cancel");
        before.press("yes"), before.press("languages");
        return before.guide.memory();
      }(),
      1000000);
  restarted.see_nobody(), restarted.wait(60000);
  ASSERT_EQ(restarted.state(), "inactive");
  EXPECT_FALSE(restarted.guide.seeks()) << "its restart has ended the visit, and no answer";
}

TEST(Guide, GoesBehindAVisitorWhoWalksAhead) {
  Rig rig;
  rig.around.pose = geometry::Pose2{4.0, 1.0, 0.0};
  rig.to_following();
  EXPECT_TRUE(rig.guide.follows());
  EXPECT_EQ(rig.guide.screen().tone, Tone::kMoving);
  rig.see(1.25), rig.wait(3000);
  EXPECT_EQ(rig.taken(), "") << "he stands before it";
  rig.see(3.0), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "goal:pose");
  EXPECT_NEAR(rig.goal_pose->x, 4.0 + 3.0 - 1.2, 1e-9);
  EXPECT_NEAR(rig.goal_pose->yaw, 0.0, 1e-9);
  rig.navigate(GoalState::kActive);
  const auto first = rig.goal;
  rig.see(3.1), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "") << "a step is no new goal";
  rig.see_at(3.0, 2.0, 1.0);  // round a corner to the left
  rig.wait(100);
  EXPECT_EQ(rig.taken(), "goal:pose");
  EXPECT_GT(rig.goal, first);
  EXPECT_NEAR(rig.goal_pose->position().x(), 7.05, 0.06) << "along his way, not across";
  EXPECT_NEAR(rig.goal_pose->yaw, 1.6, 0.1);
  rig.wait(1000);  // the navigator still speaks of the goal before
  EXPECT_EQ(rig.state(), "follow_me");
  rig.navigate(GoalState::kActive);
  rig.see(1.0), rig.wait(100);
  EXPECT_EQ(rig.taken(), "cancel") << "he has stopped";
  rig.wait(100);
  EXPECT_EQ(rig.taken(), "cancel") << "the navigator has not heard it";
  rig.navigate(GoalState::kCancelled);
  EXPECT_EQ(rig.taken(), "");
  rig.press("done");
  EXPECT_EQ(rig.taken(), "end");
  EXPECT_EQ(rig.guide.visit().arrived, 1U);
  EXPECT_FALSE(rig.guide.follows());
}

TEST(Guide, SoundsBeforeItFollowsAVisitorWhoStoodForLong) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(1.0), rig.wait(60000), rig.taken();
  rig.see(3.0), rig.wait(100);
  EXPECT_EQ(rig.toned_ms, rig.now_ms);
  rig.wait(900);
  EXPECT_EQ(rig.taken(), "");
  rig.wait(100);
  EXPECT_EQ(rig.taken(), "goal:pose");
  rig.navigate(GoalState::kSucceeded);
  rig.around.pose->x = 1.8;
  rig.see(1.0), rig.wait(3000), rig.taken();
  rig.see(3.0), rig.wait(100);
  EXPECT_EQ(rig.taken(), "goal:pose") << "he has hardly stood";
}

TEST(Guide, StandsInAFollowingUntilTheToneAfterSomebodysStop) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100), rig.navigate(GoalState::kActive), rig.taken();
  rig.around.permission = Permission::kStopped, rig.wait(5000);
  EXPECT_EQ(rig.taken(), "stop");
  rig.see(5.0), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "");
  rig.around.permission = Permission::kGiven, rig.wait(1000);
  EXPECT_EQ(rig.taken(), "");
  EXPECT_EQ(rig.toned_ms, rig.now_ms - 900);
  rig.wait(200);
  EXPECT_EQ(rig.taken(), "on goal:pose");
}

TEST(Guide, LooksForALostLeaderWhereHeWasAndCalls) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.navigate(GoalState::kSucceeded);
  rig.around.pose = geometry::Pose2{1.8, 0.0, 0.0};
  rig.taken(), rig.said.clear();
  rig.see_nobody(), rig.wait(700);
  EXPECT_EQ(rig.taken(), "") << "hidden for a moment";
  rig.wait(700);
  EXPECT_EQ(rig.taken(), "goal:pose");
  EXPECT_NEAR(rig.goal_pose->x, 2.7, 1e-9);
  EXPECT_EQ(rig.guide.screen().text, "I cannot see you. Please come back to me.");
  rig.navigate(GoalState::kSucceeded);
  rig.wait(10500);
  EXPECT_EQ(rig.said, std::vector<std::string>(3, "I cannot see you. Please come back to me."));
  rig.see(1.5), rig.wait(200);
  EXPECT_EQ(rig.guide.screen().text, "Walk ahead. Choose Done when we are there.");
}

TEST(Guide, FollowsAgainAfterAHaltAndNeverPastTheVisitor) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.navigate(GoalState::kSucceeded);
  rig.around.supervisor = Supervisor::kAvailable;  // the navigation is over for it
  rig.taken();
  rig.see(1.0), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "") << "he came back; the way that he went leads past him";
  rig.see(4.0), rig.wait(100);
  EXPECT_EQ(rig.taken(), "start:visitor go goal:pose");
}

TEST(Guide, AnOperatorsCancelEndsAFollowing) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.navigate(GoalState::kActive);
  rig.navigate(GoalState::kCancelled);
  EXPECT_EQ(rig.state(), "guide_error");
}

TEST(Guide, ASilentNavigatorEndsAFollowingHoweverTheVisitorWalks) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  for (int i = 0; i < 50; ++i) rig.see(2.0 + 0.1 * i), rig.wait(100);
  EXPECT_EQ(rig.state(), "follow_me");
  for (int i = 0; i < 30; ++i) rig.see(7.0 + 0.1 * i), rig.wait(100);
  EXPECT_EQ(rig.state(), "guide_error");
}

TEST(Guide, FollowsOnlyWhomItSees) {
  Rig rig;
  rig.to_location_ask(), rig.press("no");
  EXPECT_FALSE(rig.offers("follow_me")) << "nobody looks";
  rig.see_nobody(), rig.wait(100);
  EXPECT_FALSE(rig.offers("follow_me"));
  rig.see(1.0), rig.wait(100);
  EXPECT_FALSE(rig.offers("follow_me")) << "no button moves under a finger";
  rig.press("where_is"), rig.press("cancel");
  EXPECT_TRUE(rig.offers("follow_me"));
  rig.see_nobody(), rig.wait(1000);
  EXPECT_TRUE(rig.offers("follow_me"));
}

TEST(Guide, EndsAFollowingThatHasNoWay) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(rig.state(), "follow_me") << i;
    rig.see(3.0), rig.wait(1100);
    rig.navigate(GoalState::kFailed);
  }
  EXPECT_EQ(rig.state(), "guide_error");
  EXPECT_EQ(rig.guide.screen().title, "Sorry, I was unable to follow you.");
  rig.press("yes");
  EXPECT_TRUE(rig.offers("follow_me")) << "that is what he wanted";
}

TEST(Guide, SaysThatSomebodyElseHasSentItElsewhere) {
  for (const auto state : {GoalState::kCancelled, GoalState::kReplaced}) {
    Rig rig;
    rig.to_active(), rig.navigate(state);
    EXPECT_TRUE(rig.guide.screen().text.starts_with("Somebody gave me another goal."));
  }
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

TEST(Guide, AFollowingThatWasRestartedGoesOn) {
  Rig before;
  before.to_following();
  before.see(3.0), before.wait(1100);
  Rig after(quick(), before.guide.memory(), 1000000);
  EXPECT_EQ(after.state(), "follow_me");
  after.around.supervisor = Supervisor::kNavigation;
  after.goal = before.goal;
  after.navigate(GoalState::kActive);
  after.taken();
  after.see(4.0), after.wait(1000);
  EXPECT_EQ(after.taken(), "goal:pose");
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
// back, what is said is short, and a robot left alone comes to rest.
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
    rig.around.supervisor = Supervisor::kAvailable;
    rig.around.permission = Permission::kGiven;
    rig.around.navigation = Navigation{};
    rig.see_nobody();
    rig.wait(400000);
    ASSERT_EQ(rig.guide.state(), State::kInactive) << "run " << run;
  }
}

}  // namespace
}  // namespace usher::guide
