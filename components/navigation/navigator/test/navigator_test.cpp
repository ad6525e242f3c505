#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "navigation/navigator/test/rig.hpp"

namespace usher::navigator {
namespace {

// --- The way that all goes well

TEST(Navigator, RunsThroughTheStatesOfTheThesis) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.s.missing = "global_planner";
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kInitialise);
  rig.s.missing.clear();
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kInactive);
  EXPECT_EQ(rig.status().state, GoalState::kIdle);
  rig.go_to("lab");
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kNewRequest);
  EXPECT_EQ(rig.status().state, GoalState::kActive);
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kActive);
  EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing);
  EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kFollow);
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  EXPECT_EQ(rig.navigator.state(), State::kSuccess);
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
  EXPECT_EQ(rig.status().progress, 1.0);
  EXPECT_EQ(rig.status().remaining, 0.0);
  EXPECT_EQ(rig.status().eta, 0.0);
  EXPECT_EQ(rig.status().location, "lab");
  EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kStop);
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kInactive);
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded) << "the outcome stays to be read";
}

TEST(Navigator, ProgressNeverFallsAndTheTimeLeftIsTrue) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(30.0);
  rig.run(20.0);
  const double left = rig.status().remaining;
  EXPECT_NEAR(left, 30.0 - rig.s.pose->x, 0.06);
  EXPECT_NEAR(rig.status().progress, rig.s.pose->x / 30.0, 0.01);
  const double eta = rig.status().eta;
  double progress = rig.status().progress;
  const double begin = rig.s.time;
  while (rig.status().state == GoalState::kActive) {
    rig.step();
    EXPECT_GE(rig.status().progress, progress);
    progress = rig.status().progress;
  }
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
  EXPECT_NEAR(rig.s.time - begin, eta, 0.1 * eta);
}

TEST(Navigator, AtDepartureItCountsTheTurnsAndBothEnds) {
  NavigatorConfig config;
  config.usual_speed = 0.5;
  config.turn_time = 3.0;
  config.start_time = 2.0;
  config.approach_time = 4.0;
  Rig rig(config);
  rig.s.pose->yaw = geometry::kPi / 2;
  rig.go(10.0);
  rig.run(0.3);
  EXPECT_NEAR(rig.status().eta, 20.0 + 3.0 * geometry::kPi / 2 + 2.0 + 4.0, 0.3);
  rig.s.pose = Pose2{9.5, 0.0, 0.0};
  rig.step();
  EXPECT_NEAR(rig.status().eta, 0.5 / 0.5 + 2.0, 1.5) << "half of the last metre";
}

TEST(Navigator, TurningInPlaceIsNoSlowDriving) {
  Rig rig;
  rig.go(30.0);
  rig.run(1.0);
  const double eta = rig.status().eta;
  rig.s.velocity = {0.0, 0.5};
  rig.run(5.0);
  EXPECT_NEAR(rig.status().eta, eta, 0.5);
  rig.s.velocity = {0.0, 0.0};
  rig.run(5.0);
  EXPECT_GT(rig.status().eta, eta + 2.0) << "standing counts";
}

TEST(Navigator, AJamIsExpectedToEndWithinTheNextMetres) {
  NavigatorConfig config;
  config.usual_speed = 0.5;
  Rig rig(config);
  rig.go(30.0);
  rig.run(1.0);
  const double eta = rig.status().eta;
  rig.s.velocity = {0.0, 0.0};
  rig.run(14.0);
  EXPECT_GT(rig.status().eta, eta + 8.0);
  rig.run(60.0);
  EXPECT_LT(rig.status().eta, 25.0 / 0.5 + 5.0 / 0.1 + 25.0);
}

TEST(Navigator, ArrivesOnlyWithinBothTolerancesAndAtRest) {
  const struct {
    const char* name;
    Pose2 pose;
    geometry::Twist2 velocity;
    bool arrived;
  } table[] = {
      {"exact", {8.0, 0.0, 0.0}, {}, true},
      {"inside", {7.8, 0.1, 0.19}, {0.04, -0.04}, true},
      {"too far", {7.7, 0.0, 0.0}, {}, false},
      {"turned away", {8.0, 0.0, 0.25}, {}, false},
      {"turned round", {8.0, 0.0, 3.14}, {}, false},
      {"rolling", {8.0, 0.0, 0.0}, {0.06, 0.0}, false},
      {"turning", {8.0, 0.0, 0.0}, {0.0, -0.06}, false},
      {"velocity unknown", {8.0, 0.0, 0.0}, {std::nan(""), 0.0}, false},
  };
  for (const auto& row : table) {
    Rig rig;
    rig.go();
    rig.run(0.3);
    rig.s.pose = row.pose;
    rig.s.velocity = row.velocity;
    rig.run(0.4);
    EXPECT_EQ(rig.status().state, GoalState::kActive) << row.name << ": not before it has settled";
    rig.run(0.4);
    EXPECT_EQ(rig.status().state == GoalState::kSucceeded, row.arrived) << row.name;
  }
}

TEST(Navigator, SaysHowFarBesideABlockedGoalItStopped) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.answer = [](Rig& r, const PlanRequest& request) {
    Rig::straight_path(r, {request.id, request.start, {7.5, 0.0, 0.0}});
  };
  rig.go();
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
  EXPECT_EQ(rig.status().reason, "0.50 m beside the goal, which is blocked");
}

// --- Requests

TEST(Navigator, RefusesAGoalWithTheReason) {
  const double nan = std::nan("");
  const struct {
    const char* name;
    GoalRequest goal;
    Failure failure;
    const char* reason;
  } table[] = {
      {"no id",
       {0, "test", "", {1, 0, 0}, 0},
       Failure::kBadGoal,
       "a goal needs an id other than 0"},
      {"NaN pose",
       {1, "test", "", {nan, 0, 0}, 0},
       Failure::kBadGoal,
       "the goal pose must be finite"},
      {"NaN yaw",
       {1, "test", "", {0, 0, nan}, 0},
       Failure::kBadGoal,
       "the goal pose must be finite"},
      {"NaN speed",
       {1, "test", "lab", {}, nan},
       Failure::kBadGoal,
       "max_speed must be 0 or more, got nan m/s"},
      {"backwards",
       {1, "test", "lab", {}, -1},
       Failure::kBadGoal,
       "max_speed must be 0 or more, got -1 m/s"},
      {"unknown",
       {1, "test", "labb", {}, 0},
       Failure::kUnknownLocation,
       "unknown location \"labb\", did you mean lab?"},
  };
  for (const auto& row : table) {
    Rig idle;
    idle.run(0.2);
    idle.navigator.request(row.goal);
    EXPECT_EQ(idle.navigator.state(), State::kFailure) << row.name;
    idle.step();
    EXPECT_EQ(idle.navigator.state(), State::kInactive) << row.name;
    EXPECT_EQ(idle.status().state, GoalState::kFailed) << row.name;
    EXPECT_EQ(idle.status().failure, row.failure) << row.name;
    EXPECT_EQ(idle.status().reason, row.reason) << row.name;
    EXPECT_TRUE(idle.plans.empty()) << row.name;

    Rig busy;
    busy.go(8.0, 7);
    busy.run(1.0);
    busy.navigator.request(row.goal);
    busy.step();
    EXPECT_EQ(busy.status().id, 7u) << row.name << ": the running goal goes on";
    EXPECT_EQ(busy.navigator.motion().mode, MotionMode::kFollow) << row.name;
    ASSERT_EQ(busy.asides.size(), 1u) << row.name;
    EXPECT_EQ(busy.asides[0].id, row.goal.id) << row.name;
    EXPECT_EQ(busy.asides[0].failure, row.failure) << row.name;
  }
}

TEST(Navigator, TakesTheNewestGoal) {
  Rig rig;
  rig.go(8.0, 1);
  rig.run(1.0);
  rig.go_to("kitchen", 2);
  rig.step();
  ASSERT_EQ(rig.asides.size(), 1u);
  EXPECT_EQ(rig.asides[0].id, 1u);
  EXPECT_EQ(rig.asides[0].state, GoalState::kReplaced);
  EXPECT_EQ(rig.status().id, 2u);
  EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kStop) << "no step on the old path";
  rig.step();
  EXPECT_EQ(rig.navigator.path().back().y, 5.0);
}

TEST(Navigator, DrivesOnWhileItsClientMovesTheGoal) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(4.0, 1);
  rig.run(2.0);
  const auto motions = rig.motions.size();
  for (std::uint64_t id = 2; id <= 6; ++id) {
    rig.go(3.0 + 0.5 * static_cast<double>(id), id);
    rig.run(0.5);
    EXPECT_EQ(rig.status().id, id);
    EXPECT_NEAR(rig.s.velocity.v, 0.5, 1e-9);
  }
  EXPECT_EQ(rig.motions.size(), motions) << "one motion with a longer path";
  EXPECT_NEAR(rig.navigator.path().back().x, 6.0, 1e-9);
  EXPECT_GT(rig.run_to_end(30.0), 0.0);
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
  EXPECT_NEAR(rig.s.pose->x, 6.0, 0.3);
}

TEST(Navigator, StandsWhenAMovedGoalHasNoPathOrIsAnotherOne) {
  const struct {
    const char* name;
    void (*answer)(Rig&, const PlanRequest&);
    double x;
    const char* client;
    double stands_after;  // [s]
  } cases[] = {{"no path", Rig::no_path, 5.0, "test", 0.2},
               {"planner silent", Rig::silence, 5.0, "test", 1.2},
               {"far away", Rig::silence, 7.0, "test", 0.1},
               {"somebody else's", Rig::silence, 5.0, "other", 0.1}};
  for (const auto& test : cases) {
    Rig rig;
    rig.drive = Rig::drive_on;
    rig.go(4.0, 1);
    rig.run(2.0);
    ASSERT_EQ(rig.navigator.motion().mode, MotionMode::kFollow);
    rig.answer = test.answer;
    rig.navigator.request({2, test.client, "", {test.x, 0.0, 0.0}, 0.0});
    rig.run(test.stands_after);
    EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kStop) << test.name;
    EXPECT_NE(rig.status().state, GoalState::kSucceeded) << test.name;
  }
}

TEST(Navigator, DrivesOnForASecondHoweverOftenTheGoalMoves) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(6.0, 1);
  rig.run(2.0);
  rig.answer = Rig::silence;
  for (std::uint64_t id = 2; id <= 5; ++id) {
    rig.go(6.0 + 0.3 * static_cast<double>(id), id);
    rig.run(0.5);
  }
  EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kStop);
  EXPECT_LT(rig.s.pose->x, 0.5 * 3.4) << "2 s before, at most 1.2 s after";
}

TEST(Navigator, DoesNotArriveAtTheGoalThatWasMoved) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(1.0, 1);
  rig.run(2.2);
  rig.answer = Rig::silence;
  rig.go(2.0, 2);
  rig.run(0.9);
  EXPECT_EQ(rig.status().state, GoalState::kActive);
}

TEST(Navigator, TakesARepeatedGoalOnce) {
  Rig rig;
  rig.drive = Rig::drive_on;
  for (int i = 0; i < 5; ++i) {
    rig.go();
    rig.run(0.2);
  }
  EXPECT_EQ(rig.plans.size(), 1u);
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  const std::size_t plans = rig.plans.size();
  rig.go();
  rig.run(1.0);
  EXPECT_EQ(rig.plans.size(), plans);
  EXPECT_EQ(rig.navigator.state(), State::kInactive) << "a late repetition does not start again";
  rig.go(9.0, 2);
  rig.run(1.0);
  EXPECT_EQ(rig.navigator.state(), State::kActive);
}

TEST(Navigator, TellsClientsWithTheSameIdApart) {
  Rig rig;
  rig.go();
  rig.run(1.0);
  rig.navigator.request({1, "another", "kitchen", {}, 0.0});
  rig.step();
  EXPECT_EQ(rig.status().client, "another");
  ASSERT_EQ(rig.asides.size(), 1u);
  EXPECT_EQ(rig.asides[0].client, "test");
}

TEST(Navigator, TakesAnotherPaceFromTheGoalsOwnClient) {
  Rig rig;
  rig.navigator.request({7, "guide", "lab", {}, 1.0});
  rig.run(1.0);
  EXPECT_EQ(rig.navigator.motion().max_speed, 1.0);
  EXPECT_FALSE(rig.navigator.pace(7, "operator", 0.5));
  EXPECT_FALSE(rig.navigator.pace(8, "guide", 0.5));
  EXPECT_FALSE(rig.navigator.pace(7, "guide", std::nan("")));
  EXPECT_FALSE(rig.navigator.pace(7, "guide", -0.1));
  rig.run(0.2);
  EXPECT_EQ(rig.navigator.motion().max_speed, 1.0);
  EXPECT_TRUE(rig.navigator.pace(7, "guide", 0.5));
  rig.run(0.2);
  EXPECT_EQ(rig.navigator.motion().max_speed, 0.5);
  rig.navigator.forget_pace();
  rig.run(0.2);
  EXPECT_EQ(rig.navigator.motion().max_speed, 1.0) << "the goal's own";
}

TEST(Navigator, CancelsByIdOrWhateverRuns) {
  const struct {
    std::uint64_t id;
    bool cancelled;
  } table[] = {{1, true}, {0, true}, {2, false}};
  for (const auto& row : table) {
    Rig rig;
    EXPECT_FALSE(rig.navigator.cancel(row.id)) << "nothing runs";
    rig.go();
    rig.run(1.0);
    EXPECT_EQ(rig.navigator.cancel(row.id), row.cancelled);
    rig.step();
    EXPECT_EQ(rig.status().state, row.cancelled ? GoalState::kCancelled : GoalState::kActive);
    EXPECT_EQ(rig.navigator.motion().mode, row.cancelled ? MotionMode::kStop : MotionMode::kFollow);
    EXPECT_FALSE(rig.navigator.cancel(row.cancelled ? 0 : row.id));
  }
}

TEST(Navigator, WaitsForPlannersThatAreNotThereYet) {
  Rig rig;
  rig.s.missing = "the local planner";
  rig.step();
  rig.go();
  rig.run(5.0);
  EXPECT_EQ(rig.navigator.state(), State::kInitialise);
  EXPECT_EQ(rig.status().state, GoalState::kWaiting);
  EXPECT_EQ(rig.status().reason, "no word from the local planner yet");
  EXPECT_TRUE(rig.plans.empty());
  rig.s.missing.clear();
  rig.run(0.3);
  EXPECT_EQ(rig.navigator.state(), State::kActive);
}

TEST(Navigator, CancelsAGoalThatWaitsForPlanners) {
  Rig rig;
  rig.s.missing = "the local planner";
  rig.step();
  rig.go();
  rig.step();
  EXPECT_TRUE(rig.navigator.cancel(1));
  rig.s.missing.clear();
  rig.run(1.0);
  EXPECT_EQ(rig.navigator.state(), State::kInactive);
  EXPECT_TRUE(rig.plans.empty());
}

// --- Planning

TEST(Navigator, RepeatsAPlanRequestFiveTimesASecondUntilAnswered) {
  Rig rig;
  rig.answer = Rig::silence;
  rig.go();
  rig.run(2.0);
  EXPECT_EQ(rig.plans.size(), 1u);
  EXPECT_NEAR(rig.plan_messages, 10, 1);
  rig.navigator.plan_reply({999, "", {{0, 0, 0}}});
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kNewRequest) << "an answer to something else";
  Rig::straight_path(rig, rig.plans.back());
  rig.step();
  EXPECT_EQ(rig.navigator.state(), State::kActive);
}

TEST(Navigator, ClearsTheCostmapBeforeItPlansAgain) {
  Rig rig;
  rig.answer = Rig::no_path;
  rig.go();
  rig.run(0.3);
  EXPECT_EQ(rig.costmap_clears, 1);
  EXPECT_EQ(rig.status().state, GoalState::kWaiting);
  EXPECT_EQ(rig.status().reason, "no path joins start and goal");
  rig.answer = Rig::straight_path;
  rig.run(1.2);
  EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing);
}

TEST(Navigator, PlansAgainWhenThereIsReason) {
  const struct {
    const char* name;
    std::function<void(Rig&)> change;  // two seconds after the first plan
    double within;                     // [s] a second plan; 0 = none for 2.5 s
  } table[] = {
      {"all is well", [](Rig&) {}, 0.0},
      {"off the path", [](Rig& r) { r.s.pose->y = 0.7; }, 0.2},
      {"beside the path", [](Rig& r) { r.s.pose->y = 0.5; }, 0.0},
      {"obstacle ahead", [](Rig& r) { r.s.follow.obstacle_distance = 2.0; }, 2.3},
      {"person ahead",
       [](Rig& r) {
         r.s.follow.obstacle_distance = 2.0;
         r.s.person_ahead = true;
       },
       0.0},
      {"obstacle far ahead", [](Rig& r) { r.s.follow.obstacle_distance = 4.0; }, 0.0},
      {"distance unknown", [](Rig& r) { r.s.follow.obstacle_distance = std::nan(""); }, 0.0},
      {"follower believes to be there", [](Rig& r) { r.s.follow.state = GoalState::kSucceeded; },
       0.2},
  };
  for (const auto& row : table) {
    Rig rig;
    rig.go();
    rig.run(2.0);
    ASSERT_EQ(rig.plans.size(), 1u);
    row.change(rig);
    rig.run(row.within > 0.0 ? row.within : 2.5);
    EXPECT_EQ(rig.plans.size(), row.within > 0.0 ? 2u : 1u) << row.name;
    EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kFollow)
        << row.name << ": drives on meanwhile";
  }
}

TEST(Navigator, PlansPeriodicallyButKeepsAPathThatIsAsGood) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(30.0);
  rig.run(10.5);
  EXPECT_EQ(rig.plans.size(), 3u);
  EXPECT_NEAR(rig.navigator.path().front().x, 0.0, 1e-9) << "the first path";
  rig.answer = [](Rig& r, const PlanRequest& request) {  // a door closed: the way is longer now
    PlanReply reply{request.id,
                    "",
                    {request.start, {request.start.x, 40.0, 0.0}, {30.0, 40.0, 0.0}, request.goal}};
    r.navigator.plan_reply(reply);
  };
  const double progress = rig.status().progress;
  rig.run(5.0);
  EXPECT_EQ(rig.navigator.path().size(), 4u);
  EXPECT_GE(rig.status().progress, progress) << "though more is left now";
  EXPECT_EQ(rig.motions.size(), 2u) << "the same task, so it does not stop to change over";

  NavigatorConfig never;
  never.replan_period = 0.0;
  Rig calm(never);
  calm.drive = Rig::drive_on;
  calm.go(30.0);
  calm.run(20.0);
  EXPECT_EQ(calm.plans.size(), 1u);
}

TEST(Navigator, TurnsBackForAGoalBehindIt) {
  Rig rig;
  rig.s.person_ahead = true;
  rig.answer = [](Rig& r, const PlanRequest& request) {
    r.navigator.plan_reply({request.id, "", {request.start, {-5.0, 0.0, 0.0}, request.goal}});
  };
  rig.go();
  rig.run(1.0);
  EXPECT_EQ(rig.navigator.path().size(), 3u);
}

/// Whoever follows it would stand in its way back, and who is ahead walks on.
TEST(Navigator, DoesNotTurnBackForSomebodyWhoIsOnTheWay) {
  for (const bool blocked : {false, true}) {
    Rig rig;
    rig.drive = Rig::drive_on;
    rig.go(30.0);
    rig.run(1.0);
    rig.s.person_ahead = true;
    rig.run(0.1);
    rig.s.person_ahead = !blocked;  // a thing, it seems, but somebody was there a moment ago
    if (blocked) rig.drive = Rig::stand_blocked;
    rig.answer = [](Rig& r, const PlanRequest& request) {  // the other way round
      const double x = request.start.x;
      r.navigator.plan_reply(
          {request.id,
           "",
           {request.start, {x - 5.0, 0.0, 0.0}, {x - 5.0, 9.0, 0.0}, request.goal}});
    };
    rig.run(6.5);
    EXPECT_GT(rig.plans.size(), 1u);
    EXPECT_NE(rig.navigator.path().size(), 4u) << blocked;
    rig.s.person_ahead = false;
    rig.run(blocked ? 3.0 : 14.0);
    EXPECT_EQ(rig.navigator.path().size(), 4u) << "he has been waited for " << blocked;
  }
}

TEST(Navigator, DrivesOnWhenAPeriodicPlanFails) {
  Rig rig;
  rig.drive = Rig::drive_on;
  rig.go(8.0);
  rig.run(2.0);
  rig.answer = Rig::no_path;
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
}

}  // namespace
}  // namespace usher::navigator
