#include "simulation/visitor/core/visitor.hpp"

#include <gtest/gtest.h>

namespace usher::visitor {
namespace {

Character kitchen() { return {.destination = "kitchen", .reading_time = 0.0}; }
Screen screen(std::uint64_t id, const char* state, std::vector<std::string> options) {
  return {.id = id, .state = state, .language = "en", .options = std::move(options)};
}
std::string chosen(Visitor& visitor, double now) {
  const auto choice = visitor.answer(now);
  return choice ? choice->option + choice->text : "";
}

TEST(Visitor, ReadsBeforeAnsweringAndAnswersOnce) {
  Character slow = kitchen();
  slow.reading_time = 2.0;
  Visitor visitor(slow);
  visitor.see(screen(1, "guide_options", {"lab", "kitchen", "cancel"}), 10.0);
  EXPECT_EQ(chosen(visitor, 11.9), "");
  EXPECT_EQ(chosen(visitor, 12.0), "kitchen");
  EXPECT_EQ(chosen(visitor, 13.0), "");
}

TEST(Visitor, ChoosesTheLanguageFirst) {
  Character french = kitchen();
  french.language = "fr";
  Visitor visitor(french);
  visitor.see(screen(1, "introduction", {"language:en", "language:fr"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "language:fr");
  Visitor english(kitchen());
  english.see(screen(1, "introduction", {"language:en", "language:fr"}), 0.0);
  EXPECT_EQ(chosen(english, 0.0), "") << "it is that already";
}

TEST(Visitor, TurnsPagesOrTypesUntilTheDestinationIsOffered) {
  Visitor visitor(kitchen());
  visitor.see(screen(1, "guide_options", {"lab", "more", "search", "cancel"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "more");
  visitor.see(screen(2, "guide_options", {"kitchen", "cancel"}), 1.0);
  EXPECT_EQ(chosen(visitor, 1.0), "kitchen");

  Character typist = kitchen();
  typist.types = true;
  Visitor types(typist);
  types.see(screen(1, "guide_options", {"lab", "search"}), 0.0);
  EXPECT_EQ(chosen(types, 0.0), "search");
  Screen line = screen(2, "guide_options", {"query", "lab"});
  line.text_option = "query";
  types.see(line, 1.0);
  EXPECT_EQ(chosen(types, 1.0), "querykitc");
  line.options = {"query", "kitchen"};
  types.see(line, 2.0);
  EXPECT_EQ(chosen(types, 2.0), "kitchen");
  line.options = {"query", "lab"};  // somebody else has spoken
  types.see(line, 3.0);
  EXPECT_EQ(chosen(types, 3.0), "querykitc");
}

TEST(Visitor, NeverStopsOrCancelsByItself) {
  Visitor visitor(kitchen());
  visitor.see(screen(1, "guide_active", {"stop", "cancel"}), 0.0);
  EXPECT_EQ(chosen(visitor, 100.0), "");
  EXPECT_EQ(visitor.walk(100.0), Walk::kFollow);
}

TEST(Visitor, StopsAndGoesOn) {
  Character careful = kitchen();
  careful.stops_at = 5.0;
  Visitor visitor(careful);
  visitor.see(screen(1, "guide_active", {"stop", "cancel"}), 0.0);
  EXPECT_EQ(chosen(visitor, 4.0), "");
  EXPECT_EQ(chosen(visitor, 5.0), "stop");
  visitor.see(screen(2, "guide_paused", {"continue", "cancel"}), 6.0);
  EXPECT_EQ(chosen(visitor, 10.0), "");
  EXPECT_EQ(chosen(visitor, 11.0), "continue");
  visitor.see(screen(3, "guide_active", {"stop", "cancel"}), 12.0);
  EXPECT_EQ(chosen(visitor, 20.0), "") << "once";
}

TEST(Visitor, ThanksAfterTheArrivalOrGoesBack) {
  Character returner = kitchen();
  returner.returns_to = "foyer";
  for (const auto& character : {kitchen(), returner}) {
    Visitor visitor(character);
    visitor.see(screen(1, "guide_active", {"stop"}), 0.0);
    visitor.see(screen(2, "guide_success", {}), 1.0);
    EXPECT_TRUE(visitor.arrived());
    visitor.see(screen(3, "end_ask", {"yes", "no"}), 2.0);
    EXPECT_EQ(chosen(visitor, 2.0), character.returns_to.empty() ? "no" : "yes");
  }
}

Screen about(std::uint64_t id, const char* state, std::vector<std::string> options,
             const char* place) {
  Screen made = screen(id, state, std::move(options));
  made.place = place;
  return made;
}

TEST(Visitor, WhoWasMisunderstoodTurnsBackAndAsksAgain) {
  Visitor visitor(kitchen());
  visitor.see(about(1, "guide_start", {"start", "cancel"}, "lab"), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "cancel");
  visitor.see(screen(2, "end_ask", {"yes", "no"}), 1.0);
  EXPECT_EQ(chosen(visitor, 1.0), "yes");
  visitor.see(screen(3, "location_ask", {"yes", "no", "guide_me"}), 2.0);
  EXPECT_EQ(chosen(visitor, 2.0), "guide_me");
  visitor.see(about(4, "guide_start", {"start", "cancel"}, "kitchen"), 3.0);
  EXPECT_EQ(chosen(visitor, 3.0), "start");
  visitor.see(about(5, "guide_active", {"stop", "cancel"}, "kitchen"), 4.0);
  EXPECT_EQ(chosen(visitor, 4.0), "");
  visitor.see(about(6, "guide_success", {}, "kitchen"), 5.0);
  visitor.see(screen(7, "end_ask", {"yes", "no"}), 6.0);
  EXPECT_EQ(chosen(visitor, 6.0), "no");
  visitor.see(screen(8, "location_ask", {"yes", "no", "guide_me"}), 7.0);
  EXPECT_EQ(chosen(visitor, 7.0), "no") << "his no was taken for a yes";
  visitor.see(screen(9, "guide_ask", {"yes", "no"}), 8.0);
  EXPECT_EQ(chosen(visitor, 8.0), "no");
  visitor.see(screen(10, "guide_options", {"kitchen", "lab", "cancel"}), 9.0);
  EXPECT_EQ(chosen(visitor, 9.0), "cancel");
}

TEST(Visitor, WhoseStartWasTakenForACancelBeginsAgainAFewTimes) {
  Visitor visitor(kitchen());
  std::uint64_t id = 0;
  for (const char* answer : {"yes", "yes", "no"}) {
    visitor.see(about(++id, "guide_start", {"start", "cancel"}, "kitchen"), 0.0);
    EXPECT_EQ(chosen(visitor, 0.0), "start");
    visitor.see(screen(++id, "end_ask", {"yes", "no"}), 1.0);
    EXPECT_EQ(chosen(visitor, 1.0), answer);
  }
  Character fickle = kitchen();
  fickle.cancels_at = 5.0;
  Visitor cancels(fickle);
  cancels.see(about(1, "guide_active", {"stop", "cancel"}, "kitchen"), 0.0);
  EXPECT_EQ(chosen(cancels, 5.0), "cancel");
  cancels.see(screen(2, "end_ask", {"yes", "no"}), 6.0);
  EXPECT_EQ(chosen(cancels, 6.0), "no") << "that was his wish";
}

TEST(Visitor, WhoWasTakenThereBeginsNoOtherVisit) {
  Visitor visitor(kitchen());
  visitor.see(screen(1, "inactive", {"language:en"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "language:en");
  visitor.see(about(2, "guide_success", {}, "kitchen"), 1.0);
  visitor.see(screen(3, "end", {"again"}), 2.0);
  visitor.see(screen(4, "inactive", {"language:en"}), 3.0);
  EXPECT_EQ(chosen(visitor, 3.0), "");
}

TEST(Visitor, WhoMissedTheLanguagesAsksForThem) {
  Character french = kitchen();
  french.language = "fr";
  Visitor visitor(french);
  std::uint64_t id = 0;
  for (int tries = 0; tries < 2; ++tries) {
    visitor.see(screen(++id, "location_ask", {"yes", "no", "guide_me", "languages"}), 0.0);
    EXPECT_EQ(chosen(visitor, 0.0), "languages");
    visitor.see(screen(++id, "introduction", {"language:en", "language:fr"}), 0.0);
    EXPECT_EQ(chosen(visitor, 0.0), "language:fr");
  }
  visitor.see(screen(++id, "location_ask", {"yes", "no", "guide_me", "languages"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "guide_me") << "this robot does not speak it";
}

TEST(Visitor, WhoIsLedElsewhereCancelsOrIsNotThereYet) {
  Visitor visitor(kitchen());
  visitor.see(about(1, "guide_active", {"stop", "cancel"}, "lab"), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "cancel");
  visitor.see(about(2, "guide_success", {}, "lab"), 1.0);
  EXPECT_FALSE(visitor.arrived());
  visitor.see(screen(3, "end_ask", {"yes", "no"}), 2.0);
  EXPECT_EQ(chosen(visitor, 2.0), "yes");
}

TEST(Visitor, WhoMissedTheMapAsksForItAgain) {
  Character curious = kitchen();
  curious.looks_at_map = true;
  Visitor visitor(curious);
  visitor.see(screen(1, "guide_ask", {"yes", "no"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "no");
  visitor.see(screen(2, "end_ask", {"yes", "no"}), 1.0);
  EXPECT_EQ(chosen(visitor, 1.0), "yes");
  visitor.see(screen(3, "location_ask", {"yes", "no"}), 2.0);
  EXPECT_EQ(chosen(visitor, 2.0), "yes");
  visitor.see(screen(4, "location_show", {"done"}), 3.0);
  EXPECT_EQ(chosen(visitor, 3.0), "done");
  visitor.see(screen(5, "guide_ask", {"yes", "no"}), 4.0);
  EXPECT_EQ(chosen(visitor, 4.0), "yes");
}

TEST(Visitor, AsksForTimeWhenItRunsOut) {
  Character slow = kitchen();
  slow.reading_time = 50.0;
  Visitor visitor(slow);
  Screen late = screen(1, "guide_ask", {"yes", "no", "stay"});
  visitor.see(late, 0.0);
  EXPECT_EQ(chosen(visitor, 40.0), "");
  late.time_left = 18.0;
  visitor.see(late, 42.0);
  EXPECT_EQ(chosen(visitor, 42.0), "stay");
}

TEST(Visitor, WalksAsItsCharacterIs) {
  Character character = kitchen();
  character.ties_lace_at = 5.0;
  character.ties_lace_for = 2.0;
  character.dawdles_at = 10.0;
  character.walks_away_at = 20.0;
  Visitor visitor(character);
  EXPECT_EQ(visitor.walk(0.0), Walk::kStand);
  visitor.see(screen(1, "guide_active", {"stop"}), 0.0);
  EXPECT_EQ(visitor.walk(1.0), Walk::kFollow);
  EXPECT_EQ(visitor.walk(6.0), Walk::kStand);
  EXPECT_EQ(visitor.walk(8.0), Walk::kFollow);
  EXPECT_EQ(visitor.walk(11.0), Walk::kDawdle);
  EXPECT_EQ(visitor.walk(21.0), Walk::kAway);
  EXPECT_EQ(visitor.walk(500.0), Walk::kAway) << "for good";
}

TEST(Visitor, ComesBackWhenItsCharacterDoes) {
  Character wanderer = kitchen();
  wanderer.walks_away_at = 10.0;
  wanderer.walks_away_for = 20.0;
  Visitor visitor(wanderer);
  visitor.see(screen(1, "guide_active", {"stop"}), 0.0);
  EXPECT_EQ(visitor.walk(9.0), Walk::kFollow);
  EXPECT_EQ(visitor.walk(11.0), Walk::kAway);
  EXPECT_EQ(visitor.walk(30.0), Walk::kFollow);
}

TEST(Visitor, GivesUpWhereItsCharacterDoes) {
  Character leaver = kitchen();
  leaver.gives_up_in = "guide_ask";
  Visitor visitor(leaver);
  visitor.see(screen(1, "guide_ask", {"yes", "no"}), 0.0);
  EXPECT_EQ(chosen(visitor, 10.0), "");
  visitor.see(screen(2, "end", {"again"}), 60.0);
  EXPECT_EQ(chosen(visitor, 70.0), "");
}

TEST(Visitor, SaysThatHeIsThereToARobotThatWaitsForHim) {
  Character lace = kitchen();
  lace.ties_lace_at = 20.0, lace.ties_lace_for = 30.0;
  Visitor visitor(lace);
  visitor.see(screen(1, "guide_active", {"stop"}), 0.0);
  visitor.see(screen(1, "guide_active", {"stop", "stay"}), 5.0);
  EXPECT_EQ(chosen(visitor, 10.9), "") << "he comes up";
  EXPECT_EQ(chosen(visitor, 11.0), "stay");
  EXPECT_EQ(chosen(visitor, 12.0), "") << "once is enough for a while";
  EXPECT_EQ(chosen(visitor, 30.0), "") << "he ties his lace";
  EXPECT_EQ(chosen(visitor, 49.9), "");
  EXPECT_EQ(chosen(visitor, 55.8), "") << "he comes up again";
  EXPECT_EQ(chosen(visitor, 56.0), "stay");
}

TEST(Visitor, WhoIsFollowedByMistakeSaysSoAndStays) {
  Visitor visitor{Character{}};
  visitor.see(screen(1, "guide_ask", {"yes", "no", "follow_me"}), 0.0);
  visitor.see(screen(2, "follow_me", {"done", "stop"}), 1.0);
  EXPECT_EQ(visitor.walk(3.0), Walk::kStand);
  EXPECT_EQ(chosen(visitor, 3.0), "done");
}

TEST(Visitor, LeadsTheRobotAndSaysWhenTheyAreThere) {
  Character leader = kitchen();
  leader.leads = true;
  Visitor visitor(leader);
  visitor.see(screen(1, "location_ask", {"yes", "no", "guide_me"}), 0.0);
  EXPECT_EQ(chosen(visitor, 0.0), "no");
  visitor.see(screen(2, "guide_ask", {"yes", "no", "follow_me"}), 1.0);
  EXPECT_EQ(chosen(visitor, 1.0), "follow_me");
  visitor.see(screen(3, "follow_me", {"done", "stop"}), 2.0);
  EXPECT_EQ(visitor.walk(2.0), Walk::kLead);
  EXPECT_EQ(chosen(visitor, 60.0), "");
  visitor.led(60.0), visitor.led(61.0);
  EXPECT_EQ(visitor.walk(61.0), Walk::kStand);
  EXPECT_EQ(chosen(visitor, 63.9), "") << "the robot comes up";
  EXPECT_EQ(chosen(visitor, 64.0), "done");
  visitor.see(screen(4, "end_ask", {"yes", "no"}), 65.0);
  EXPECT_EQ(visitor.walk(66.0), Walk::kStand);
  Visitor unseen(leader);
  unseen.see(screen(1, "guide_ask", {"yes", "no"}), 0.0);
  EXPECT_EQ(chosen(unseen, 0.0), "yes") << "a robot that sees nobody cannot follow";
}

TEST(Visitor, WhoLeadsComesBackWhenTheRobotCalls) {
  Character leader = kitchen();
  leader.leads = true;
  Visitor visitor(leader);
  Screen following = screen(1, "follow_me", {"done", "stop"});
  visitor.see(following, 0.0);
  following.calls = true;
  visitor.see(following, 10.0);
  EXPECT_EQ(visitor.walk(10.5), Walk::kLead) << "he has not heard it out";
  EXPECT_EQ(visitor.walk(11.0), Walk::kReturn);
  following.calls.reset();
  visitor.see(following, 12.0);
  EXPECT_EQ(visitor.walk(12.0), Walk::kReturn) << "a sound";
  following.calls = false;
  visitor.see(following, 13.0);
  EXPECT_EQ(visitor.walk(13.0), Walk::kLead);
}

TEST(Visitor, BlocksTheWayAndIsCrowdedForAWhile) {
  Character crowded = kitchen();
  crowded.blocks_at = 5.0, crowded.blocks_for = 10.0;
  crowded.crowd_at = 8.0, crowded.crowd_for = 2.0;
  Visitor visitor(crowded);
  EXPECT_FALSE(visitor.crowded(9.0)) << "not before the departure";
  visitor.see(screen(1, "guide_active", {"stop"}), 100.0);
  EXPECT_EQ(visitor.walk(104.9), Walk::kFollow);
  EXPECT_EQ(visitor.walk(105.0), Walk::kBlock);
  EXPECT_EQ(visitor.walk(115.0), Walk::kFollow);
  EXPECT_FALSE(visitor.crowded(107.9));
  EXPECT_TRUE(visitor.crowded(108.0));
  EXPECT_FALSE(visitor.crowded(110.0));
}

TEST(Visitor, AnswersSomeAllOrNoneOfTheStatements) {
  const struct {
    const char* rates;
    int answered;
  } cases[] = {{"none", 0}, {"some", 4}, {"all", 13}};
  for (const auto& test : cases) {
    Character polite = kitchen();
    polite.rates = test.rates;
    Visitor visitor(polite);
    std::vector<std::string> options{"skip", "cancel"};
    for (int i = 1; i <= 5; ++i) options.push_back("rating:" + std::to_string(i));
    int answered = 0;
    for (std::uint64_t id = 1; id <= 13; ++id) {
      visitor.see(screen(id, "feedback", options), static_cast<double>(id));
      const std::string choice = chosen(visitor, static_cast<double>(id));
      ASSERT_FALSE(choice.empty());
      if (choice == "cancel") break;
      ++answered;
    }
    EXPECT_EQ(answered, test.answered) << test.rates;
  }
}

}  // namespace
}  // namespace usher::visitor
