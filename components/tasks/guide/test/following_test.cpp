#include <gtest/gtest.h>

#include "visit_rig.hpp"

namespace usher::guide {
namespace {

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
  rig.drive(10500);
  EXPECT_EQ(rig.said, std::vector<std::string>(3, "I cannot see you. Please come back to me."));
  rig.see(1.5), rig.wait(200);
  EXPECT_EQ(rig.guide.screen().text, "Walk ahead. Choose Done when we are there.");
}

TEST(Guide, LooksRoundWhereALostLeaderIsNot) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.see_nobody(), rig.wait(1500);
  rig.navigate(GoalState::kSucceeded);
  rig.around.pose = geometry::Pose2{2.7, 0.0, 0.0};
  rig.taken(), rig.wait(1500);
  EXPECT_EQ(rig.taken(), "") << "it looks";
  rig.wait(600);
  EXPECT_EQ(rig.taken(), "goal:pose");
  EXPECT_NEAR(rig.goal_pose->x, 2.7, 1e-9);
  EXPECT_NEAR(rig.goal_pose->yaw, 1.2, 1e-9);
  rig.navigate(GoalState::kSucceeded);
  rig.around.pose->yaw = 1.2;
  rig.wait(2100);
  EXPECT_NEAR(rig.goal_pose->yaw, 2.4, 1e-9);
  rig.navigate(GoalState::kActive), rig.taken();
  rig.see(2.5), rig.wait(100);
  EXPECT_EQ(rig.taken(), "cancel") << "there he is";
}

TEST(Guide, LooksRoundWhenTheWayToWhereALeaderWasIsBlocked) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.see_nobody(), rig.wait(1500);
  rig.navigate(GoalState::kActive);
  rig.around.navigation->blocked = true, rig.taken();
  rig.wait(3500);
  EXPECT_EQ(rig.taken(), "");
  rig.wait(1000);
  EXPECT_EQ(rig.taken(), "goal:pose");
  EXPECT_NEAR(rig.goal_pose->x, 0.0, 1e-9);
  EXPECT_NEAR(rig.goal_pose->yaw, 1.2, 1e-9);
  for (int i = 0; i < 5; ++i) rig.navigate(GoalState::kFailed), rig.wait(2100);
  EXPECT_EQ(rig.state(), "follow_me") << "a turn that fails is no way that fails";
  EXPECT_NEAR(rig.goal_pose->x, 0.0, 1e-9);
  rig.navigate(GoalState::kSucceeded), rig.wait(2100);
  EXPECT_NEAR(rig.goal_pose->x, 2.7, 1e-9) << "after a whole turn it tries the way again";
}

TEST(Guide, BetweenTwoGoalsOfAFollowingNothingIsMissing) {
  Rig rig;
  rig.around.pose = geometry::Pose2{0.0, 0.0, 0.0};
  rig.to_following();
  rig.see(3.0), rig.wait(1100);
  rig.navigate(GoalState::kSucceeded);
  rig.around.supervisor = Supervisor::kAvailable;
  rig.see(1.0), rig.wait(3000);
  EXPECT_EQ(rig.guide.screen().text, "Walk ahead. Choose Done when we are there.");
  rig.around.permission = Permission::kRefused, rig.wait(1100);
  EXPECT_EQ(rig.guide.screen().text, "One moment, please. I have to wait for a part of me.");
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

}  // namespace
}  // namespace usher::guide
