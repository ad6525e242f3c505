#include <gtest/gtest.h>

#include "visit_rig.hpp"

namespace usher::guide {
namespace {

TEST(Guide, TakesAStopHoweverLateItsScreenIs) {
  Rig rig;
  rig.to_active();
  rig.note(rig.guide.answer({1, "stop"}, rig.now()));
  EXPECT_EQ(rig.state(), "guide_paused");
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
  EXPECT_EQ(after.guide.screen().title, "Unterwegs: AM218.");
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

TEST(Guide, AGoalThatEndsInAPauseIsGivenAgain) {
  Rig rig;
  rig.to_active(), rig.press("stop");
  rig.navigate(GoalState::kFailed), rig.wait(2000);
  EXPECT_EQ(rig.state(), "guide_paused") << "the visitor has more patience than the navigator";
  EXPECT_EQ(rig.taken(), "stop");
  rig.press("continue"), rig.wait(1000);
  EXPECT_EQ(rig.taken(), "on goal:am218");
}

TEST(Guide, AsksAgainAfterARestart) {
  Rig rig;
  rig.to_location_ask();
  Rig after(quick(), rig.guide.memory(), 1000000);
  ASSERT_FALSE(after.said.empty());
  EXPECT_EQ(after.said.front(), "Would you like to see our location?");
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

}  // namespace
}  // namespace usher::guide
