#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "foundation/random/random.hpp"
#include "navigation/navigator/test/rig.hpp"

namespace usher::navigator {
namespace {

// --- Every failure

TEST(NavigatorInTrouble, FailsInTheEndWithTheReason) {
  const NavigatorConfig config;
  const struct {
    const char* name;
    std::function<void(Rig&)> before;  // the goal
    std::function<void(Rig&)> after;   // one second after it
    Failure failure;
    const char* reason;
    double earliest, latest;  // [s]
  } table[] = {
      {"planners never come",
       [](Rig& r) { r.s.missing = "the global planner"; },
       {},
       Failure::kNotReady,
       "no word from the global planner for 30 s",
       29.0,
       31.0},
      {"no path",
       [](Rig& r) { r.answer = Rig::no_path; },
       {},
       Failure::kNoPath,
       "no path joins start and goal",
       2.0,
       4.0},
      {"a path of NaN",
       [](Rig& r) {
         r.answer = [](Rig& rig, const PlanRequest& request) {
           rig.navigator.plan_reply({request.id, "", {{std::nan(""), 0, 0}}});
         };
       },
       {},
       Failure::kNoPath,
       "no path",
       2.0,
       4.0},
      {"planner silent",
       [](Rig& r) { r.answer = Rig::silence; },
       {},
       Failure::kPlannerSilent,
       "the global planner did not answer for 5 s",
       16.0,
       19.0},
      {"blocked for good", [](Rig&) {}, [](Rig& r) { r.drive = Rig::stand_blocked; },
       Failure::kBlocked, "an obstacle 0.4 m ahead", 30.0, 90.0},
      {"blocked by a person for good", [](Rig& r) { r.s.person_ahead = true; },
       [](Rig& r) { r.drive = Rig::stand_blocked; }, Failure::kBlocked, "an obstacle 0.4 m ahead",
       70.0, 150.0},
      {"blocked, and the recovery motions never end", [](Rig&) {},
       [](Rig& r) {
         r.drive = [](Rig& rig) {
           Rig::stand_blocked(rig);
           if (rig.navigator.motion().mode != MotionMode::kFollow)
             rig.s.follow.state = GoalState::kActive;
         };
       },
       Failure::kBlocked, "an obstacle 0.4 m ahead", 60.0, 150.0},
      {"the follower gives up", [](Rig&) {},
       [](Rig& r) {
         r.drive = [](Rig& rig) {
           rig.s.follow.state = GoalState::kFailed;
           rig.s.follow.reason = "path refused";
         };
       },
       Failure::kBlocked, "path refused", 3.0, 60.0},
      {"the follower believes to drive",
       [](Rig&) {},
       {},
       Failure::kBlocked,
       "no progress for 15 s",
       90.0,
       180.0},
      {"the way closes while driving", [](Rig&) {},
       [](Rig& r) {
         r.drive = Rig::stand_blocked;
         r.answer = Rig::no_path;
       },
       Failure::kNoPath, "no path joins start and goal", 15.0, 90.0},
      {"lost", [](Rig&) {}, [](Rig& r) { r.s.localization = Localization::kLost; },
       Failure::kLocalizationLost, "robot not localized for 60 s", 60.0, 63.0},
      {"no pose", [](Rig&) {}, [](Rig& r) { r.s.pose.reset(); }, Failure::kLocalizationLost,
       "robot not localized for 60 s", 60.0, 63.0},
      {"pose of NaN", [](Rig&) {}, [](Rig& r) { r.s.pose->x = std::nan(""); },
       Failure::kLocalizationLost, "robot not localized for 60 s", 60.0, 63.0},
      {"never localized",
       [](Rig& r) { r.s.pose.reset(); },
       {},
       Failure::kLocalizationLost,
       "robot not localized for 60 s",
       60.0,
       63.0},
      {"stale", [](Rig&) {}, [](Rig& r) { r.s.stale = "the odometry"; }, Failure::kInputsStale,
       "no word from the odometry for 60 s", 60.0, 63.0},
      {"held", [](Rig&) {}, [](Rig& r) { r.s.not_allowed_because = "movement is switched off"; },
       Failure::kHeld, "movement is switched off for 300 s", 300.0, 303.0},
      {"the global planner dies before there is a path", [](Rig& r) { r.answer = Rig::silence; },
       [](Rig& r) { r.s.missing = "the global planner"; }, Failure::kInputsStale,
       "no word from the global planner for 60 s", 60.0, 63.0},
      {"to and fro for ever", [](Rig&) {},
       [](Rig& r) {
         r.drive = [](Rig& rig) {  // moves, but every path is as long as the last
           rig.s.follow.state = GoalState::kActive;
           rig.s.pose->x = std::fmod(rig.s.time, 2.0);
         };
       },
       Failure::kTooSlow, "not there after 3", 180.0, 400.0},
  };
  std::set<Failure> seen = {Failure::kNone, Failure::kBadGoal, Failure::kUnknownLocation};
  for (const auto& row : table) {
    Rig rig(config);
    row.before(rig);
    rig.step();
    rig.go();
    rig.run(1.0);
    if (row.after) row.after(rig);
    const double took = 1.0 + rig.run_to_end(600.0);
    EXPECT_EQ(rig.status().state, GoalState::kFailed) << row.name;
    EXPECT_EQ(rig.status().failure, row.failure) << row.name << ": " << rig.status().reason;
    EXPECT_EQ(rig.status().reason.rfind(row.reason, 0), 0u)
        << row.name << ": " << rig.status().reason;
    EXPECT_GE(took, row.earliest) << row.name;
    EXPECT_LE(took, row.latest) << row.name;
    EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kStop) << row.name;
    seen.insert(row.failure);
    rig.run(0.2);
    EXPECT_TRUE(rig.navigator.state() == State::kInactive ||
                rig.navigator.state() == State::kInitialise)
        << row.name;
  }
  for (int i = 0; i <= static_cast<int>(Failure::kTooSlow); ++i)
    EXPECT_TRUE(seen.contains(static_cast<Failure>(i)))
        << name(static_cast<Failure>(i)) << " has no row";
}

// --- Blocked

TEST(NavigatorInTrouble, WaitsBeforeItPlansRoundWhatBlocks) {
  const struct {
    bool person;
    double wait;
  } table[] = {{false, 2.0}, {true, 8.0}};
  for (const auto& row : table) {
    Rig rig;
    rig.go();
    rig.run(0.5);
    rig.drive = Rig::stand_blocked;
    rig.s.person_ahead = row.person;
    rig.run(row.wait - 0.2);
    EXPECT_EQ(rig.navigator.phase(), Phase::kBlocked);
    EXPECT_EQ(rig.status().state, GoalState::kWaiting);
    EXPECT_EQ(rig.status().reason, "an obstacle 0.4 m ahead");
    EXPECT_EQ(rig.plans.size(), 1u) << "patience first";
    rig.run(0.5);
    EXPECT_EQ(rig.plans.size(), 2u);
    EXPECT_EQ(rig.status().recoveries, 0u);
  }
}

TEST(NavigatorInTrouble, HasArrivedWhereNothingBringsItNearer) {
  for (const bool near : {true, false}) {
    Rig rig;
    rig.go();  // to (8, 0)
    rig.run(0.5);
    rig.s.pose = Pose2{near ? 7.7 : 7.6, 0.0, 2.0};
    rig.drive = Rig::stand_blocked;
    ASSERT_FALSE(std::isnan(rig.run_to_end(300.0)));
    EXPECT_EQ(rig.status().state, near ? GoalState::kSucceeded : GoalState::kFailed);
    EXPECT_EQ(rig.status().recoveries, near ? 3u : 6u);
    EXPECT_EQ(rig.status().reason,
              near ? "0.30 m from the goal, which is blocked" : "an obstacle 0.4 m ahead");
  }
}

TEST(NavigatorInTrouble, ReplansWhileAStandingRobotStillFollows) {
  Rig rig;
  rig.go();
  rig.run(0.5);
  rig.drive = Rig::stand_blocked;
  rig.run(3.0);
  EXPECT_EQ(rig.navigator.motion().mode, MotionMode::kFollow) << "drives on as soon as it can";
}

TEST(NavigatorInTrouble, DrivesOnWhenThePersonSteppedAside) {
  Rig rig;
  rig.go();
  rig.run(0.5);
  rig.drive = Rig::stand_blocked;
  rig.s.person_ahead = true;
  rig.run(5.0);
  rig.drive = Rig::drive_on;
  rig.s.follow.state = GoalState::kActive;
  rig.run(0.2);
  EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing);
  EXPECT_EQ(rig.status().state, GoalState::kActive);
  EXPECT_EQ(rig.status().reason, "");
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
  EXPECT_EQ(rig.status().recoveries, 0u);
}

/// The recoveries that a blocked robot tries, in order.
std::vector<MotionMode> recoveries(Rig& rig) {
  rig.go();
  rig.run(0.5);
  rig.drive = Rig::stand_blocked;
  rig.run_to_end(300.0);
  std::vector<MotionMode> modes;
  for (std::size_t i = 2; i < rig.motions.size(); ++i) modes.push_back(rig.motions[i].mode);
  return modes;
}

TEST(NavigatorInTrouble, ClearsThenBacksOffThenLooks) {
  using enum MotionMode;
  Rig rig;
  rig.s.rear_clearance = 1.0;
  EXPECT_EQ(
      recoveries(rig),
      (std::vector{kStop, kFollow, kBackOff, kStop, kFollow, kRotate, kStop, kFollow,  //
                   kStop, kFollow, kBackOff, kStop, kFollow, kRotate, kStop, kFollow, kStop}));
  EXPECT_EQ(rig.status().recoveries, 6u);
  EXPECT_EQ(rig.costmap_clears, 2);
}

TEST(NavigatorInTrouble, LooksInsteadWhereNothingIsKnownFreeBehind) {
  using enum MotionMode;
  for (const double clearance : {0.0, 0.49}) {
    Rig rig;
    rig.s.rear_clearance = clearance;
    const auto modes = recoveries(rig);
    EXPECT_EQ(std::ranges::count(modes, kBackOff), 0);
    EXPECT_EQ(std::ranges::count(modes, kRotate), 4);
  }
}

TEST(NavigatorInTrouble, LooksToBothSides) {
  Rig rig;
  recoveries(rig);
  std::vector<double> turns;
  for (const Motion& motion : rig.motions)
    if (motion.mode == MotionMode::kRotate) turns.push_back(motion.amount);
  ASSERT_GE(turns.size(), 2u);
  EXPECT_LT(*std::ranges::min_element(turns), 0.0);
  EXPECT_GT(*std::ranges::max_element(turns), 0.0);
}

TEST(NavigatorInTrouble, StopsBackingOffWhenSomebodyIsBehind) {
  Rig rig;
  rig.s.rear_clearance = 1.0;
  rig.go();
  rig.run(0.5);
  rig.drive = [](Rig& r) {
    Rig::stand_blocked(r);
    if (r.navigator.motion().mode == MotionMode::kBackOff) r.s.follow.state = GoalState::kActive;
  };
  while (rig.navigator.phase() != Phase::kBackingOff && rig.s.time < 60.0) rig.step();
  ASSERT_EQ(rig.navigator.phase(), Phase::kBackingOff);
  rig.run(0.5);
  EXPECT_EQ(rig.navigator.phase(), Phase::kBackingOff);
  rig.s.rear_clearance = 0.1;
  rig.step();
  EXPECT_NE(rig.navigator.motion().mode, MotionMode::kBackOff);
}

TEST(NavigatorInTrouble, BacksOffFartherForTheNextGoalUntilItGotAway) {
  const auto first_way_back = [](Rig& rig, std::uint64_t id) {
    rig.motions.clear();
    rig.go(8.0, id);
    rig.run_to_end(300.0);
    EXPECT_EQ(rig.status().failure, Failure::kBlocked);
    for (const Motion& motion : rig.motions)
      if (motion.mode == MotionMode::kBackOff) return motion.amount;
    return 0.0;
  };
  Rig rig;
  rig.s.rear_clearance = 2.0;
  rig.drive = Rig::stand_blocked;
  EXPECT_NEAR(first_way_back(rig, 1), 0.3, 1e-9);
  EXPECT_NEAR(first_way_back(rig, 2), 0.9, 1e-9);
  rig.s.pose->x += 1.1;
  EXPECT_NEAR(first_way_back(rig, 3), 0.3, 1e-9);
}

TEST(NavigatorInTrouble, NoNewPathHidesThatItGetsNoNearer) {
  Rig rig;
  rig.go();
  rig.run(0.5);
  rig.drive = [](Rig& r) {  // away from the goal: each path that is planned anew is longer
    if (r.navigator.motion().mode != MotionMode::kFollow) return Rig::stand_blocked(r);
    r.s.pose->x -= 0.01;
    r.s.velocity.v = -0.1;
    r.s.follow.state = GoalState::kActive;
  };
  const double began = rig.s.time;
  while (rig.status().recoveries == 0 && rig.s.time - began < 60.0) rig.step();
  EXPECT_LT(rig.s.time - began, 17.0);
  EXPECT_GE(rig.plans.size(), 3u);
}

TEST(NavigatorInTrouble, ForgivesRecoveriesAfterProgress) {
  Rig rig;
  rig.go(100.0);
  rig.run(0.5);
  for (int jam = 0; jam < 8; ++jam) {  // more jams than recoveries in a row are allowed
    rig.drive = Rig::stand_blocked;
    const std::uint32_t before = rig.status().recoveries;
    while (rig.status().recoveries == before && rig.s.time < 300.0) rig.step();
    rig.drive = Rig::drive_on;
    rig.run(6.0);
    ASSERT_EQ(rig.status().state, GoalState::kActive) << jam << ": " << rig.status().reason;
  }
  EXPECT_EQ(rig.status().recoveries, 8u);
}

// --- Paused

TEST(NavigatorInTrouble, PausesAndGoesOnWithANewPath) {
  const struct {
    const char* name;
    std::function<void(Rig&)> lose, regain;
    const char* reason;
  } table[] = {
      {"localization", [](Rig& r) { r.s.localization = Localization::kLost; },
       [](Rig& r) { r.s.localization = Localization::kGood; }, "robot not localized"},
      {"pose", [](Rig& r) { r.s.pose.reset(); },
       [](Rig& r) {
         r.s.pose = Pose2{3.0, 0.0, 0.0};
       },
       "robot not localized"},
      {"odom", [](Rig& r) { r.s.stale = "the odometry"; }, [](Rig& r) { r.s.stale.clear(); },
       "no word from the odometry"},
      {"permission", [](Rig& r) { r.s.not_allowed_because = "movement is switched off"; },
       [](Rig& r) { r.s.not_allowed_because.clear(); }, "movement is switched off"},
  };
  for (const auto& row : table) {
    Rig rig;
    rig.go();
    rig.run(1.0);
    row.lose(rig);
    const Decision decision = rig.step();
    ASSERT_TRUE(decision.motion) << row.name;
    EXPECT_EQ(decision.motion->mode, MotionMode::kStop) << row.name << ": in the same step";
    EXPECT_EQ(rig.navigator.phase(), Phase::kPaused) << row.name;
    EXPECT_EQ(rig.status().state, GoalState::kWaiting) << row.name;
    EXPECT_EQ(rig.status().reason, row.reason) << row.name;
    rig.run(20.0);
    EXPECT_EQ(rig.plans.size(), 1u) << row.name;
    row.regain(rig);
    rig.run(0.3);
    EXPECT_EQ(rig.plans.size(), 2u) << row.name;
    EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing) << row.name;
    EXPECT_EQ(rig.status().reason, "") << row.name;
  }
}

TEST(NavigatorInTrouble, DrivesOnWithoutTheGlobalPlannerAsLongAsItsPathServes) {
  Rig rig;
  rig.go();
  rig.run(1.0);
  rig.s.missing = "the global planner";
  rig.drive = Rig::drive_on;
  rig.run(5.0);
  EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing);
  rig.drive = Rig::stand_blocked;
  rig.answer = Rig::silence;
  rig.run(20.0);
  EXPECT_EQ(rig.navigator.phase(), Phase::kPaused) << "a new path would be needed";
  EXPECT_EQ(rig.status().reason, "no word from the global planner");
  rig.s.missing.clear();
  rig.answer = Rig::straight_path;
  rig.drive = Rig::drive_on;
  ASSERT_FALSE(std::isnan(rig.run_to_end(60.0)));
  EXPECT_EQ(rig.status().state, GoalState::kSucceeded);
}

TEST(NavigatorInTrouble, IgnoresAnAnswerFromBeforeThePause) {
  Rig rig;
  rig.answer = Rig::silence;
  rig.go();
  rig.run(0.5);
  rig.s.stale = "the odometry";
  rig.step();
  Rig::straight_path(rig, rig.plans.back());
  rig.run(0.5);
  rig.s.stale.clear();
  rig.run(0.5);
  EXPECT_EQ(rig.navigator.phase(), Phase::kPlanning);
  EXPECT_EQ(rig.plans.size(), 2u);
}

TEST(NavigatorInTrouble, DrivesSlowerWhileLocalizationIsDegraded) {
  Rig rig;
  rig.navigator.request({1, "test", "lab", {}, 1.0});
  rig.run(1.0);
  EXPECT_EQ(rig.navigator.motion().max_speed, 1.0);
  rig.s.localization = Localization::kDegraded;
  const Decision slower = rig.step();
  ASSERT_TRUE(slower.motion);
  EXPECT_EQ(slower.motion->max_speed, 0.5);
  EXPECT_EQ(slower.motion->id, rig.motions.back().id) << "the same task";
  rig.s.localization = Localization::kGood;
  EXPECT_EQ(rig.step().motion->max_speed, 1.0);
}

TEST(NavigatorInTrouble, RepeatsAMotionUntilTheFollowerNamesIt) {
  Rig rig;
  rig.follower_hears = false;
  rig.go();
  rig.run(0.3);
  int sent = 0;
  for (int i = 0; i < 20; ++i) sent += rig.step().motion ? 1 : 0;
  EXPECT_NEAR(sent, 10, 1);
  rig.s.follow.id = rig.navigator.motion().id;
  rig.s.follow.state = GoalState::kActive;
  sent = 0;
  for (int i = 0; i < 20; ++i) sent += rig.step().motion ? 1 : 0;
  EXPECT_EQ(sent, 0);
  rig.s.follow = {};  // the follower was restarted and knows nothing
  EXPECT_TRUE(rig.step().motion);
}

TEST(NavigatorInTrouble, DoesNotBelieveAFollowerThatSpeaksOfAnotherMotion) {
  Rig rig;
  rig.follower_hears = false;
  rig.go();
  rig.run(0.5);
  rig.s.follow = {
      .id = 12345, .state = GoalState::kWaiting, .reason = "old", .obstacle_distance = 0.1};
  rig.run(5.0);
  EXPECT_EQ(rig.navigator.phase(), Phase::kFollowing);
}

// --- As a whole

TEST(NavigatorInTrouble, EndsEveryGoalWhateverHappens) {
  // Seeded chaos: each goal must have an outcome within its bound, and the robot stands whenever it
  // should.
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    Rig rig;
    rig.answer = [&](Rig& r, const PlanRequest& request) {
      const double dice = random.uniform();
      if (dice < 0.5) return Rig::straight_path(r, request);
      if (dice < 0.8) return Rig::no_path(r, request);
    };
    rig.drive = [&](Rig& r) {
      if (random.uniform() < 0.1) r.s.follow.state = static_cast<GoalState>(random.below(7));
      if (random.uniform() < 0.02) r.s.localization = static_cast<Localization>(random.below(3));
      if (random.uniform() < 0.02) r.s.stale = random.uniform() < 0.3 ? "the odometry" : "";
      if (random.uniform() < 0.02) r.s.missing = random.uniform() < 0.2 ? "the global planner" : "";
      if (random.uniform() < 0.1) r.s.person_ahead = random.uniform() < 0.5;
      if (random.uniform() < 0.1) r.s.rear_clearance = random.uniform(0.0, 1.0);
      if (random.uniform() < 0.1) r.s.follow.obstacle_distance = random.uniform(0.0, 5.0);
      if (r.s.pose && random.uniform() < 0.5) r.s.pose->x += random.uniform(-0.1, 0.12);
      if (random.uniform() < 0.01)
        r.s.pose = random.uniform() < 0.3 ? std::optional<Pose2>() : Pose2{};
    };
    rig.go(8.0, seed);
    const double took = rig.run_to_end(2000.0);
    ASSERT_FALSE(std::isnan(took)) << "seed " << seed;
    ASSERT_EQ(rig.navigator.motion().mode, MotionMode::kStop) << "seed " << seed;
    if (rig.status().state == GoalState::kFailed) {
      ASSERT_NE(rig.status().failure, Failure::kNone) << "seed " << seed;
      ASSERT_FALSE(rig.status().reason.empty()) << "seed " << seed;
    }
  }
}

TEST(NavigatorInTrouble, RefusesAConfigurationByTheFieldsName) {
  NavigatorConfig config;
  config.stall_time = 0.0;
  EXPECT_EQ(Navigator::create(config, site()).error(), "stall_time must be in [1, 120], got 0");
  config = {};
  config.wait_person = 1.0;  // less than for a thing
  EXPECT_EQ(Navigator::create(config, site()).error(), "wait_person must be in [2, 120], got 1");
  config = {};
  config.yaw_tolerance = std::nan("");
  EXPECT_EQ(Navigator::create(config, site()).error(),
            "yaw_tolerance must be in [0.01, 3.2], got nan");
}

TEST(NavigatorInTrouble, HasNamesForEverything) {
  for (int i = 0; i <= static_cast<int>(State::kFailure); ++i)
    EXPECT_STRNE(name(static_cast<State>(i)), "unknown");
  for (int i = 0; i <= static_cast<int>(Phase::kLooking); ++i)
    EXPECT_STRNE(name(static_cast<Phase>(i)), "unknown");
  for (int i = 0; i <= static_cast<int>(Failure::kTooSlow); ++i)
    EXPECT_STRNE(name(static_cast<Failure>(i)), "unknown");
}

}  // namespace
}  // namespace usher::navigator
