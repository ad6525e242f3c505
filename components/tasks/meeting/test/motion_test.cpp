#include "tasks/meeting/core/motion.hpp"

#include <gtest/gtest.h>

#include "meeting_rig.hpp"

namespace usher::meeting {
namespace {

using Outcome = Motion::Outcome;

/// A journey beside a robot that is told by hand what it does.
struct Bench {
  Motion motion{{}, 100};
  Surroundings robot;
  int now_ms = 0;
  std::string done;
  Bench() {
    robot.supervisor = Supervisor::kAvailable;
    robot.navigation = GoalReport{};
    robot.exploration = GoalReport{};
  }
  Time now() const { return milliseconds(now_ms); }
  Outcome wait(int ms) {
    Outcome outcome = Outcome::kBusy;
    for (const int end = now_ms + ms; now_ms < end && outcome == Outcome::kBusy;) {
      now_ms += 100;
      outcome = motion.step(robot, now());
      const MotionActions actions = motion.take_actions();
      const char* const names[] = {"start", "go", "end", "stop", "on"};
      for (const auto& request : actions.requests)
        done += std::string(" ") + names[static_cast<int>(request.kind)];
      if (actions.cancel) done += " cancel";
      if (actions.stop_exploring) done += " stop";
      if (actions.goal) done += " goal";
      if (actions.explore) done += actions.explore->anew ? " anew" : " explore";
    }
    return outcome;
  }
  std::string taken() { return std::exchange(done, {}); }
  void drive() { motion.drive({0, "room", {}}, now()); }
  void to_driving() {
    drive();
    wait(100);
    robot.supervisor = Supervisor::kNavigation;
    wait(100);
    robot.navigation = GoalReport{motion.goal_id(), GoalState::kActive, {}};
    wait(100);
    taken();
  }
};

TEST(Motion, GoesWithASupervisorThatLetsItGoLateAndGivesItBackInAnyCase) {
  Bench late;
  late.drive();
  late.wait(100);
  late.robot.supervisor = Supervisor::kInactive;  // something died; the request is remembered
  late.wait(5000);
  late.robot.supervisor = Supervisor::kNavigation;
  late.taken();
  late.wait(200);
  EXPECT_EQ(late.taken(), " goal");
  Bench never;
  never.drive();
  never.wait(100);
  never.robot.supervisor = Supervisor::kInactive;
  never.taken();
  EXPECT_EQ(never.wait(100000), Outcome::kFailed);
  EXPECT_EQ(never.taken(), " end");
}

TEST(Motion, AsksForTheNavigationThenGivesTheGoal) {
  Bench bench;
  bench.drive();
  bench.wait(100);
  EXPECT_EQ(bench.taken(), " start go");
  bench.wait(500);
  EXPECT_EQ(bench.taken(), "");
  bench.robot.supervisor = Supervisor::kNavigation;
  bench.wait(100);
  EXPECT_EQ(bench.taken(), " goal");
  bench.robot.navigation = GoalReport{bench.motion.goal_id(), GoalState::kSucceeded, {}};
  EXPECT_EQ(bench.wait(100), Outcome::kArrived);
  EXPECT_TRUE(bench.motion.resting());
  EXPECT_FALSE(bench.motion.may_turn(bench.robot)) << "not before the supervisor is back";
  bench.robot.supervisor = Supervisor::kAvailable;
  EXPECT_TRUE(bench.motion.may_turn(bench.robot));
}

TEST(Motion, NamesEachJourneyToTheSupervisor) {
  const auto name = [](void (*begin)(Motion&)) {
    Bench bench;
    begin(bench.motion);
    bench.motion.step(bench.robot, milliseconds(100));
    return bench.motion.take_actions().requests.at(0).goal;
  };
  EXPECT_EQ(name([](Motion& m) { m.drive({0, "room", {}}, {}); }), "room");
  EXPECT_EQ(name([](Motion& m) { m.drive({0, {}, {1.0, 2.0, 0.0}}, {}); }), "person");
  EXPECT_EQ(name([](Motion& m) { m.explore(false, {}); }), "exploration");
}

TEST(Motion, ExploresAnewOnceThoughItIsReplacedBefore) {
  Bench bench;
  bench.motion.explore(true, bench.now());
  bench.wait(100);
  bench.drive();
  bench.wait(100);
  bench.motion.explore(false, bench.now());
  bench.wait(100);
  bench.robot.supervisor = Supervisor::kNavigation;
  bench.wait(100);
  EXPECT_NE(bench.taken().find(" anew"), std::string::npos);
  bench.motion.rest();
  bench.wait(100);
  EXPECT_EQ(bench.taken(), " end stop");
}

TEST(Motion, GivesUpWhatRunsWhenItRests) {
  Bench bench;
  bench.to_driving();
  bench.motion.rest();
  bench.wait(100);
  EXPECT_EQ(bench.taken(), " end cancel");
  bench.wait(2000);
  EXPECT_EQ(bench.taken(), " end") << "the supervisor still navigates: it is told again";
  bench.robot.supervisor = Supervisor::kAvailable;
  bench.wait(5000);
  EXPECT_EQ(bench.taken(), "");
}

TEST(Motion, AsksASupervisorThatForgotTheJourneyAnew) {
  Bench bench;
  bench.to_driving();
  bench.robot.supervisor = Supervisor::kAvailable;
  bench.wait(1900);
  EXPECT_EQ(bench.taken(), "");
  bench.wait(200);
  EXPECT_EQ(bench.taken(), " start go");
}

TEST(Motion, FailsWithAReason) {
  const auto reason = [](void (*act)(Bench&), int ms) {
    Bench bench;
    bench.to_driving();
    act(bench);
    EXPECT_EQ(bench.wait(ms), Outcome::kFailed);
    EXPECT_TRUE(bench.motion.resting());
    return bench.motion.reason();
  };
  EXPECT_EQ(reason(
                [](Bench& b) {
                  b.robot.navigation->state = GoalState::kFailed,
                  b.robot.navigation->reason = "no path";
                },
                100),
            "no path");
  EXPECT_EQ(reason([](Bench& b) { b.robot.navigation.reset(); }, 5100), "the navigator is silent");
  EXPECT_EQ(reason([](Bench& b) { b.robot.navigation->id = 7; }, 100),
            "the navigator follows another goal");
  EXPECT_EQ(reason([](Bench& b) { b.robot.navigation->state = GoalState::kReplaced; }, 100),
            "somebody else ended the drive");
  Bench bench;
  bench.drive();
  bench.wait(100);
  bench.robot.supervisor = Supervisor::kNavigation;
  EXPECT_EQ(bench.wait(6000), Outcome::kFailed);
  EXPECT_EQ(bench.motion.reason(), "the navigator does not take the goal");
  Bench held;
  held.robot.supervisor = Supervisor::kInactive;
  held.drive();
  EXPECT_EQ(held.wait(89900), Outcome::kBusy);
  EXPECT_EQ(held.wait(200), Outcome::kFailed);
  EXPECT_EQ(held.motion.reason(), "the supervisor does not let me drive");
}

}  // namespace
}  // namespace usher::meeting
