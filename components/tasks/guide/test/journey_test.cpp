#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "visit_rig.hpp"

namespace usher::guide {
namespace {

TEST(Guide, TellsTimeAndWayAtTheStartAndAtTheEnd) {
  Rig rig;
  rig.to_active();
  for (int i = 0; i <= 40; ++i) {
    rig.around.navigation->remaining = 40.0 - i;
    rig.around.navigation->eta = (40.0 - i) * 1.75;
    rig.around.navigation->progress = i / 40.0;
    rig.wait(1000);
  }
  std::string all;
  for (const auto& sentence : rig.said) all += sentence + "|";
  EXPECT_NE(all.find("It is 40 metres, about one minute."), std::string::npos) << all;
  EXPECT_NE(all.find("We are almost there."), std::string::npos) << all;
  EXPECT_EQ(all.find("It is"), all.rfind("It is")) << "said once: " << all;
  rig.navigate(GoalState::kSucceeded);
  EXPECT_NEAR(rig.guide.visit().eta_error, 41.0 / 70.0 - 1.0, 0.05);
}

TEST(Guide, TellsNoWayBeforeThereIsAPlan) {
  Rig rig;
  rig.to_active();
  rig.around.navigation->remaining = 0.0;
  rig.around.navigation->eta = std::nan("");
  rig.wait(2000);
  EXPECT_TRUE(std::isnan(rig.guide.screen().remaining));
}

TEST(Guide, TellsHalfMinutesInEveryLanguage) {
  constexpr std::array kOneAndAHalf{"about one and a half minutes.", "kotahi meneti me te haurua.",
                                    "etwa eineinhalb Minuten.", "environ une minute et demie."};
  constexpr std::array kFourAndAHalf{"about four and a half minutes.", "whā meneti me te haurua.",
                                     "etwa viereinhalb Minuten.",
                                     "environ quatre minutes et demie."};
  const std::array kTags{"en", "mi", "de", "fr"};
  for (std::size_t language = 0; language < kTags.size(); ++language) {
    Rig rig;
    rig.press(std::string("language:") + kTags[language]), rig.wait(3000);
    for (const char* button : {"guide_me", "am218", "start"}) rig.press(button);
    rig.around.supervisor = Supervisor::kNavigation;
    rig.wait(1000);
    rig.navigate(GoalState::kActive);
    rig.around.navigation->remaining = 60.0;
    for (const auto& [eta, words] :
         {std::pair{87.0, kOneAndAHalf[language]}, std::pair{266.0, kFourAndAHalf[language]}}) {
      rig.around.navigation->eta = eta;
      rig.wait(5000);
      EXPECT_TRUE(rig.guide.screen().text.ends_with(words)) << rig.guide.screen().text;
    }
  }
  Rig rig;
  rig.to_active();
  rig.around.navigation->remaining = 60.0;
  for (const auto& [eta, words] :
       {std::pair{59.0, "less than a minute."}, std::pair{118.0, "about 2 minutes."},
        std::pair{400.0, "about 7 minutes."}}) {
    rig.around.navigation->eta = eta;
    rig.wait(5000);
    EXPECT_TRUE(rig.guide.screen().text.ends_with(words)) << rig.guide.screen().text;
  }
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
  EXPECT_EQ(rig.guide.screen().status, "Something is in my way");
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

TEST(Guide, AJamThatLastsIsNoWay) {
  Rig rig;
  rig.to_active();
  rig.around.navigation->blocked = true;
  rig.wait(200000);
  rig.around.pose->x += 3.5, rig.wait(250000);
  EXPECT_EQ(rig.state(), "guide_active") << "it gets on, slowly";
  rig.around.navigation->blocked = false, rig.wait(1000);
  rig.around.navigation->blocked = true, rig.around.pose->x += 0.5, rig.wait(60000);
  EXPECT_EQ(rig.state(), "guide_error");
  EXPECT_TRUE(rig.offers("yes")) << "another try";
  Rig stopped;
  stopped.to_active();
  stopped.around.navigation->blocked = true, stopped.wait(150000);
  stopped.around.permission = Permission::kStopped, stopped.wait(60000);
  stopped.around.permission = Permission::kGiven, stopped.wait(150000);
  EXPECT_EQ(stopped.state(), "guide_active") << "it was stopped meanwhile";
  Rig free;
  free.to_active(), free.wait(600000);
  EXPECT_EQ(free.state(), "guide_active") << "nobody is in the way";
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

TEST(Guide, TurnsToTheVisitorOnArrival) {
  Rig rig;
  rig.see(-1.5), rig.to_active();
  EXPECT_FALSE(rig.guide.turns_to());
  rig.navigate(GoalState::kSucceeded);
  EXPECT_EQ(rig.toned_ms, rig.now_ms);
  EXPECT_EQ(rig.guide.screen().spoken, "We have arrived. Here it is – AM218.") << "with the tone";
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

TEST(Guide, SaysThatItIsLostWhenItsGoalFailsWithoutAPose) {
  Rig rig;
  rig.to_active();
  rig.around.pose.reset();
  rig.navigate(GoalState::kFailed);
  ASSERT_EQ(rig.state(), "guide_error");
  EXPECT_NE(rig.guide.screen().text.find("not sure where we are"), std::string::npos)
      << rig.guide.screen().text;
}

TEST(Guide, SaysThatSomebodyElseHasSentItElsewhere) {
  for (const auto state : {GoalState::kCancelled, GoalState::kReplaced}) {
    Rig rig;
    rig.to_active(), rig.navigate(state);
    EXPECT_TRUE(rig.guide.screen().text.starts_with("Somebody gave me another goal."));
  }
}

}  // namespace
}  // namespace usher::guide
