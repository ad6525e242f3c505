#include "control/supervisor/core/supervisor.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "control/supervisor/test/robot.hpp"

namespace usher::supervisor {
namespace {

TEST(Supervisor, GrantsWhenAllIsThere) {
  const Robot robot = ready();
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_EQ(robot.supervisor.decision().grant.writer, kMovement);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 1U);
  EXPECT_EQ(robot.reason(), "");
  EXPECT_TRUE(robot.supervisor.decision().enables.interaction);
  EXPECT_EQ(robot.supervisor.decision().speed_factor, 1.0);
}

TEST(Supervisor, WaitsForTheWriter) {
  Robot robot;
  robot.run(1000);
  EXPECT_EQ(robot.state(), State::kInitialise);
  EXPECT_FALSE(robot.granted());
  EXPECT_EQ(robot.reason(), "movement_control: writes no drive/command yet");
}

struct Loss {
  const char* name;
  void (*lose)(Robot&);
  void (*regain)(Robot&);
  bool stops;
  double speed_factor;
  const char* reason;
};

TEST(Supervisor, EveryLossMeansWhatTheManifestSays) {
  const Loss losses[] = {
      {"critical component silent", [](Robot& r) { r.silent.insert("amcl"); },
       [](Robot& r) { r.silent.clear(); }, true, 0.5, "amcl: silent"},
      {"movement_control silent", [](Robot& r) { r.silent.insert("movement_control"); },
       [](Robot& r) { r.silent.clear(); }, true, 0.5, "movement_control: silent"},
      {"base driver silent", [](Robot& r) { r.silent.insert("segway_rmp"); },
       [](Robot& r) { r.silent.clear(); }, true, 0.5, "segway_rmp: silent"},
      {"critical component starts anew", [](Robot& r) { r.starting.insert("amcl"); },
       [](Robot& r) { r.starting.clear(); }, true, 0.5, "amcl: starting"},
      {"critical component of another IDL", [](Robot& r) { r.other_idl.insert("amcl"); },
       [](Robot& r) { r.other_idl.clear(); }, true, 0.5,
       "amcl: built from another IDL than the supervisor"},
      {"writer of drive/command gone",
       [](Robot& r) { r.supervisor.writer_gone(kDrive, kMovement); }, [](Robot& r) { r.appear(); },
       true, 1.0, "movement_control: writes no drive/command yet"},
      {"base driver lives, its status does not", [](Robot& r) { r.base_unheard = true; },
       [](Robot& r) { r.base_unheard = false; }, true, 1.0, "segway_rmp: base/status is silent"},
      {"status older than its arrival", [](Robot& r) { r.base.age = milliseconds(150); },
       [](Robot& r) { r.base.age = {}; }, true, 1.0, "segway_rmp: base/status is silent"},
      {"degrading component silent", [](Robot& r) { r.silent.insert("people_detector"); },
       [](Robot& r) { r.silent.clear(); }, false, 0.5, "people_detector: silent"},
      {"degrading component of another IDL",
       [](Robot& r) { r.other_idl.insert("people_detector"); },
       [](Robot& r) { r.other_idl.clear(); }, false, 0.5,
       "people_detector: built from another IDL than the supervisor"},
      {"notifying component silent", [](Robot& r) { r.silent.insert("tablet"); },
       [](Robot& r) { r.silent.clear(); }, false, 1.0, ""},
  };
  for (const Loss& loss : losses) {
    SCOPED_TRACE(loss.name);
    Robot robot = guiding();
    loss.lose(robot);
    robot.run(400);
    EXPECT_EQ(robot.granted(), !loss.stops);
    EXPECT_EQ(robot.state(), loss.stops ? State::kInactive : State::kNavigationActive);
    EXPECT_EQ(robot.reason(), loss.reason);
    EXPECT_EQ(robot.supervisor.decision().speed_factor, loss.speed_factor);
    EXPECT_EQ(robot.supervisor.decision().enables.movement, !loss.stops);
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
    loss.regain(robot);
    robot.run(20);
    EXPECT_EQ(robot.state(), loss.stops ? State::kInactive : State::kNavigationActive);
    robot.run(300);
    EXPECT_TRUE(robot.granted()) << robot.reason();
    EXPECT_EQ(robot.state(), State::kNavigationActive) << "resumes by itself";
    EXPECT_EQ(robot.supervisor.decision().speed_factor, 1.0);
    EXPECT_EQ(robot.supervisor.decision().grant.epoch, loss.stops ? 2U : 1U);
  }
}

TEST(Supervisor, LossIsNoticedWithinItsTimeout) {
  Robot robot = ready();
  robot.silent.insert("amcl");
  robot.run(80);
  EXPECT_TRUE(robot.granted());
  robot.run(20);
  EXPECT_FALSE(robot.granted());
}

TEST(Supervisor, LossIsLoggedWithCauseTimeAndComponent) {
  Robot robot = ready();
  robot.silent.insert("amcl");
  robot.run(200);
  SupervisorStatus status = robot.supervisor.status();
  ASSERT_EQ(status.faults.size(), 1U);
  EXPECT_EQ(status.faults[0].cause, Cause::kComponentLost);
  EXPECT_EQ(status.faults[0].component, "amcl");
  EXPECT_EQ(status.faults[0].at, milliseconds(500));
  EXPECT_TRUE(status.faults[0].active);
  EXPECT_FALSE(status.faults[0].latched());
  robot.silent.clear();
  robot.run(100);
  status = robot.supervisor.status();
  ASSERT_EQ(status.faults.size(), 1U);
  EXPECT_FALSE(status.faults[0].active);
}

TEST(Supervisor, GuidesByRequestsAndNavigatorStatus) {
  Robot robot = guiding();
  EXPECT_EQ(robot.supervisor.status().current_goal, "am218");
  robot.supervisor.navigation(41, GoalState::kWaiting);
  robot.run(1000);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  robot.supervisor.navigation(41, GoalState::kSucceeded);
  robot.run(20);
  EXPECT_EQ(robot.state(), State::kNavigationEnd);
  EXPECT_FALSE(robot.supervisor.decision().enables.movement);
  robot.run(600);
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_EQ(robot.supervisor.status().current_goal, "");
}

TEST(Supervisor, AnOldNavigatorStatusEndsNothing) {
  Robot robot = ready();
  robot.supervisor.navigation(40, GoalState::kSucceeded);  // the goal of before, latched
  robot.ask(Command::kNavigationStart, "am218");
  robot.run(300);
  robot.ask(Command::kNavigationGo);
  robot.supervisor.navigation(40, GoalState::kSucceeded);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  robot.supervisor.navigation(41, GoalState::kFailed);  // refused before it was ever active
  robot.run(20);
  EXPECT_EQ(robot.state(), State::kNavigationEnd);
}

TEST(Supervisor, AReplacedGoalIsNoEnd) {
  Robot robot = guiding();
  robot.supervisor.navigation(41, GoalState::kReplaced);
  robot.supervisor.navigation(42, GoalState::kActive);
  robot.run(100);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  robot.supervisor.navigation(42, GoalState::kCancelled);
  robot.run(20);
  EXPECT_EQ(robot.state(), State::kNavigationEnd);
}

TEST(Supervisor, ARefusedForeignGoalDoesNotEndTheOneThatRuns) {
  Robot robot = guiding();
  for (const auto state : {GoalState::kFailed, GoalState::kCancelled}) {
    robot.supervisor.navigation(99, state);
    robot.run(1000);
    EXPECT_EQ(robot.state(), State::kNavigationActive);
  }
  robot.supervisor.navigation(41, GoalState::kWaiting);
  robot.run(100);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  robot.supervisor.navigation(41, GoalState::kSucceeded);
  robot.run(20);
  EXPECT_EQ(robot.state(), State::kNavigationEnd);
}

TEST(Supervisor, AnExplorationIsAJourneyOfManyGoals) {
  Robot robot = guiding();
  const std::string client = "operator";
  robot.supervisor.exploration("somebody else", true);
  robot.supervisor.exploration(client, true);
  for (const auto state : {GoalState::kSucceeded, GoalState::kFailed}) {
    robot.supervisor.navigation(41, state);
    robot.supervisor.navigation(42, GoalState::kActive);
    robot.run(300);
    EXPECT_EQ(robot.state(), State::kNavigationActive);
  }
  robot.supervisor.exploration("somebody else", false);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  robot.supervisor.exploration(client, false);
  robot.run(20);
  EXPECT_EQ(robot.state(), State::kNavigationEnd) << "with the exploration";
}

TEST(Supervisor, AGoalEndsTheNavigationWhenTheExplorerIsLostOrAnotherJourneyBegins) {
  for (const bool lost : {true, false}) {
    Robot robot = guiding();
    robot.supervisor.exploration("operator", true);
    if (lost) {
      robot.supervisor.exploration_lost();
    } else {
      robot.ask(Command::kNavigationStart, "am218");
      robot.run(600);
      robot.ask(Command::kNavigationGo);
      robot.run(600);
    }
    robot.supervisor.navigation(43, GoalState::kActive);
    robot.supervisor.navigation(43, GoalState::kSucceeded);
    robot.run(20);
    EXPECT_EQ(robot.state(), State::kNavigationEnd) << lost;
  }
}

TEST(Supervisor, StopHoldsUntilMovementOn) {
  Robot robot = guiding();
  EXPECT_TRUE(robot.ask(Command::kStop).done);
  EXPECT_FALSE(robot.supervisor.decision().enables.movement);
  robot.run(5000);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  EXPECT_FALSE(robot.supervisor.decision().enables.movement);
  robot.ask(Command::kNavigationEnd);
  robot.run(1000);
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_FALSE(robot.supervisor.decision().enables.movement) << "in every state";
  EXPECT_TRUE(robot.ask(Command::kMovementOn).done);
  EXPECT_TRUE(robot.supervisor.decision().enables.movement);
}

TEST(Supervisor, AVisitorsContinueDoesNotEndAnOperatorsStop) {
  Robot robot = guiding();
  const auto ask_as = [&](const char* client, Command command) {
    robot.supervisor.request({++robot.request_id, client, command, ""}, robot.now());
    return robot.supervisor.step(robot.now()).enables.movement;
  };
  EXPECT_FALSE(ask_as("guide", Command::kStop));
  EXPECT_FALSE(ask_as("operator", Command::kStop));
  EXPECT_FALSE(ask_as("guide", Command::kMovementOn));
  EXPECT_EQ(robot.supervisor.status().stopped_by, std::vector<std::string>{"operator"});
  EXPECT_TRUE(ask_as("operator", Command::kMovementOn));
  EXPECT_FALSE(ask_as("guide", Command::kStop));
  EXPECT_TRUE(ask_as("manual_control", Command::kMovementOn)) << "an operator ends all stops";
}

TEST(Supervisor, MayStartStopped) {
  Parameters stopped = parameters();
  stopped.movement_on_at_start = false;
  Robot robot(stopped);
  robot.appear();
  robot.run(400);
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_FALSE(robot.supervisor.decision().enables.movement);
  robot.ask(Command::kMovementOn);
  EXPECT_TRUE(robot.supervisor.decision().enables.movement);
}

TEST(Supervisor, ManualEndsTheGuidance) {
  Robot robot = guiding();
  EXPECT_TRUE(robot.ask(Command::kManualOn).done);
  EXPECT_EQ(robot.state(), State::kInactive);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kManual);
  EXPECT_TRUE(
      robot.ask(Command::kNavigationStart, "am218").reason.starts_with("an operator drives: "));
  EXPECT_TRUE(robot.ask(Command::kManualOff).done);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kInteraction);
}

TEST(Supervisor, AnOperatorDrivesOnAfterARestart) {
  Robot first = ready();
  first.ask(Command::kManualOn);
  Robot second(parameters(), first.supervisor.memory());
  second.appear();
  second.run(1000);
  EXPECT_EQ(second.state(), State::kManual);
  EXPECT_FALSE(second.supervisor.decision().enables.interaction);
  EXPECT_TRUE(second.ask(Command::kManualOff).done);
  second.run(300);
  EXPECT_EQ(second.state(), State::kInteraction);
}

TEST(Supervisor, RefusesWithAReason) {
  Robot robot;
  EXPECT_EQ(robot.ask(Command::kManualOn).reason.rfind("still initialising", 0), 0U);
  robot = ready();
  EXPECT_EQ(robot.ask(Command::kNavigationStart).reason, "a goal's name was expected");
  EXPECT_EQ(robot.ask(Command::kNavigationGo).reason, "no goal was chosen");
  EXPECT_EQ(robot.ask(Command::kNone).reason, "unknown command 0");
  EXPECT_EQ(robot.ask(static_cast<Command>(77)).reason, "unknown command 77");
  robot.ask(Command::kEmergencyStop);
  EXPECT_FALSE(robot.ask(Command::kManualOn).done);
  EXPECT_FALSE(robot.ask(Command::kNavigationStart, "am218").done);
}

TEST(Supervisor, ARepeatedRequestActsOnce) {
  Robot robot = ready();
  const Request request{7, "guide", Command::kNavigationStart, "am218"};
  EXPECT_TRUE(robot.supervisor.request(request, robot.now()).done);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kNavigationStart);
  robot.ask(Command::kNavigationEnd);
  robot.run(600);
  EXPECT_TRUE(robot.supervisor.request(request, robot.now()).done);
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_TRUE(
      robot.supervisor.request({7, "tablet", Command::kNavigationStart, "x"}, robot.now()).done)
      << "another client's 7 is another request";
  robot.run(300);
  EXPECT_EQ(robot.state(), State::kNavigationStart);
  EXPECT_EQ(robot.supervisor.status().last_request.id, 7U);
}

// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): in the order of the table
struct Latched {
  const char* name;
  void (*cause)(Robot&);
  void (*heal)(Robot&);
  Cause expected;
  const char* component;
  bool emergency_stop;
  bool clearable_before_healing;
};

TEST(Supervisor, LatchesUntilAnOperatorClears) {
  const Latched cases[] = {
      {"foreign writer", [](Robot& r) { r.appear(kRogue, "teleop_of_bob"); },
       [](Robot& r) { r.supervisor.writer_gone(kDrive, kRogue); }, Cause::kForeignWriter,
       "teleop_of_bob", false, false},
      {"second live claimer", [](Robot& r) { r.appear(kReplacement); },
       [](Robot& r) { r.supervisor.writer_gone(kDrive, kReplacement); }, Cause::kForeignWriter,
       "movement_control", false, false},
      {"emergency request", [](Robot& r) { r.ask(Command::kEmergencyStop); }, [](Robot&) {},
       Cause::kEmergencyStop, "operator", true, true},
      {"emergency at the base", [](Robot& r) { r.base.emergency = true; },
       [](Robot& r) { r.base.emergency = false; }, Cause::kEmergencyStop, "segway_rmp", true, true},
      {"disobeying base",
       [](Robot& r) {
         r.base.measured = {1.0, 0.0}, r.run(2000);
       },
       [](Robot& r) { r.base.measured = {}; }, Cause::kDisobeyingBase, "segway_rmp", true, false},
  };
  for (const Latched& test : cases) {
    SCOPED_TRACE(test.name);
    Robot robot = guiding();
    test.cause(robot);
    robot.run(100);
    EXPECT_EQ(robot.state(), State::kFault);
    EXPECT_FALSE(robot.granted());
    EXPECT_EQ(robot.supervisor.decision().enables, Enables{});
    EXPECT_EQ(robot.supervisor.decision().emergency_stop, test.emergency_stop);
    const SupervisorStatus status = robot.supervisor.status();
    ASSERT_EQ(status.faults.size(), 1U);
    EXPECT_EQ(status.faults[0].cause, test.expected);
    EXPECT_EQ(status.faults[0].component, test.component);
    EXPECT_TRUE(status.faults[0].latched() && status.faults[0].active);
    EXPECT_NE(robot.reason().find(test.component), std::string::npos);

    EXPECT_EQ(robot.ask(Command::kClear).done, test.clearable_before_healing);
    test.heal(robot);
    robot.run(5000);
    if (!test.clearable_before_healing) {
      EXPECT_EQ(robot.state(), State::kFault) << "healing alone does not clear";
      EXPECT_TRUE(robot.ask(Command::kClear).done);
    }
    robot.run(300);
    EXPECT_EQ(robot.state(), State::kInteraction) << robot.reason();
    EXPECT_TRUE(robot.granted());
    EXPECT_GT(robot.supervisor.decision().grant.epoch, 1U);
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
  }
}

TEST(Supervisor, ReportsAForeignWriterWithinOneStepAndByName) {
  Robot robot = guiding();
  robot.appear(kRogue, "teleop_of_bob");
  robot.supervisor.step(robot.now());
  EXPECT_FALSE(robot.granted());
  EXPECT_NE(robot.reason().find("teleop_of_bob"), std::string::npos);
  EXPECT_NE(robot.reason().find(drive::to_string(kRogue)), std::string::npos);
}

Parameters watching_everything() {
  Parameters given = parameters();
  given.topics.push_back({"cmd_vel/manual", {"manual_control", "operator"}});
  given.topics.push_back({"drive/grant", {"supervisor"}});
  given.topics.push_back({"scan", {"lms100"}, false});
  return given;
}

TEST(Supervisor, StopsForAForeignWriterOnEveryTopicThatItWatches) {
  for (const char* topic : {"drive/command", "cmd_vel/manual", "drive/grant", "scan"}) {
    SCOPED_TRACE(topic);
    Robot robot(watching_everything());
    robot.appear();
    robot.run(400);
    ASSERT_TRUE(robot.granted());
    robot.supervisor.writer_appeared(topic, {kRogue, "teleop_of_bob", "laptop"}, robot.now());
    robot.supervisor.step(robot.now());
    EXPECT_EQ(robot.state(), State::kFault);
    EXPECT_FALSE(robot.granted());
    EXPECT_NE(robot.reason().find(topic), std::string::npos) << robot.reason();
    EXPECT_NE(robot.reason().find("teleop_of_bob"), std::string::npos);
    const Answer refused = robot.ask(Command::kClear);
    EXPECT_EQ(refused.reason, std::string("'teleop_of_bob' still writes ") + topic);
    robot.supervisor.writer_gone(topic, kRogue);
    EXPECT_TRUE(robot.ask(Command::kClear).done);
    robot.run(300);
    EXPECT_TRUE(robot.granted());
  }
}

TEST(Supervisor, SaysWhoWritesSinceWhenAndWhetherItMay) {
  Robot robot(watching_everything());
  robot.appear();
  robot.run(400);
  robot.supervisor.writer_appeared("cmd_vel/manual", {kReplacement, "operator", "nuc"},
                                   robot.now());
  robot.supervisor.writer_appeared("cmd_vel/manual", {kRogue, "teleop_of_bob", "laptop"},
                                   robot.now());
  robot.supervisor.writer_appeared("scan", {kReplacement, "lms100", "nuc"}, robot.now());
  robot.supervisor.writer_appeared("joy", {kRogue, "teleop_of_bob", "laptop"}, robot.now());
  const std::vector<CommandWriter> before = robot.supervisor.status().writers;
  ASSERT_EQ(before.size(), 3U);
  EXPECT_EQ(before[0].topic, "drive/command");
  EXPECT_TRUE(before[0].allowed && before[0].granted);
  EXPECT_EQ(before[1].sighting.participant, "operator");
  EXPECT_TRUE(before[1].allowed);
  EXPECT_FALSE(before[1].granted);
  EXPECT_EQ(before[2].sighting.host, "laptop");
  EXPECT_EQ(before[2].since, milliseconds(400));
  EXPECT_FALSE(before[2].allowed);
  robot.run(20);
  EXPECT_FALSE(robot.supervisor.status().writers[0].granted) << "the right was withdrawn";
  robot.supervisor.writer_appeared("scan", {kRogue, "teleop_of_bob", "laptop"}, robot.now());
  EXPECT_EQ(robot.supervisor.status().writers.back().topic, "scan") << "of a foreign one only";
}

TEST(Supervisor, ARepeatedRequestIsAnsweredThoughAnotherCameBetween) {
  Robot robot = ready();
  robot.supervisor.request({1, "tablet", Command::kStop, ""}, robot.now());
  robot.supervisor.request({7, "guide", Command::kStop, ""}, robot.now());
  robot.supervisor.request({1, "tablet", Command::kStop, ""}, robot.now());
  EXPECT_EQ(robot.supervisor.status().last_request.id, 1U);
  EXPECT_EQ(robot.supervisor.status().last_client, "tablet");
}

TEST(Supervisor, AFullDiskIsToldAndBarsNothing) {
  Robot robot = ready();
  robot.supervisor.memory_kept(Error{"cannot write /run/x: No space left on device"}, robot.now());
  robot.run(200);
  EXPECT_TRUE(robot.granted());
  EXPECT_EQ(robot.reason(), "");
  const Fault fault = robot.supervisor.status().faults.back();
  EXPECT_EQ(fault.cause, Cause::kNotKept);
  EXPECT_NE(fault.detail.find("No space left"), std::string::npos);
  EXPECT_TRUE(fault.active);
  EXPECT_FALSE(fault.latched());
  robot.supervisor.memory_kept({}, robot.now());
  EXPECT_FALSE(robot.supervisor.status().faults.back().active);
}

TEST(Supervisor, OnlyAnOperatorClears) {
  Robot robot = ready();
  robot.ask(Command::kEmergencyStop);
  robot.run(100);  // the operator is answered first
  const Answer answer = robot.supervisor.request({1, "tablet", Command::kClear, ""}, robot.now());
  EXPECT_FALSE(answer.done);
  EXPECT_EQ(answer.reason, "only an operator may clear faults");
  EXPECT_EQ(robot.supervisor.status().last_client, "tablet");
  robot.run(100);
  EXPECT_EQ(robot.state(), State::kFault);
  EXPECT_TRUE(robot.ask(Command::kClear).done);
  const Fault fault = robot.supervisor.status().faults.at(0);
  EXPECT_FALSE(fault.active);
  EXPECT_EQ(fault.ended, robot.now());
  EXPECT_EQ(fault.ended_by, "operator");
}

TEST(Supervisor, SwitchesTheMotorsOffForOperatorsOnly) {
  const Request requests[] = {{1, "tablet", Command::kEmergencyStop, ""},
                              {2, "operator", Command::kEmergencyStop, "", false}};
  for (const Request& request : requests) {
    SCOPED_TRACE(request.client);
    Robot robot = guiding();
    const Answer answer = robot.supervisor.request(request, robot.now());
    EXPECT_FALSE(answer.done);
    EXPECT_EQ(answer.reason, "stopped; only an operator may switch the motors off");
    robot.run(100);
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
    EXPECT_FALSE(robot.supervisor.decision().enables.movement);
    EXPECT_EQ(robot.reason(), "stopped by " + request.client);
    EXPECT_TRUE(robot.supervisor.status().faults.empty());
  }
}

TEST(Supervisor, WithdrawsTheRightFromAHolderWhoDrivesOnWhileStopped) {
  Robot robot = guiding();
  robot.command = {0.5, 0.1};
  robot.run(1000);
  robot.ask(Command::kStop);
  robot.run(380);
  EXPECT_TRUE(robot.granted()) << "he may not have heard of it";
  robot.run(60);
  EXPECT_FALSE(robot.granted());
  EXPECT_EQ(robot.state(), State::kFault);
  EXPECT_FALSE(robot.supervisor.decision().emergency_stop) << "a base that stands needs none";
  const Fault fault = robot.supervisor.status().faults.back();
  EXPECT_EQ(fault.cause, Cause::kMovesWhileStopped);
  EXPECT_EQ(fault.component, "movement_control");
  EXPECT_TRUE(fault.latched());
  robot.command = {};
  robot.run(40);
  EXPECT_TRUE(robot.ask(Command::kClear).done);
  robot.ask(Command::kMovementOn);
  robot.run(600);
  EXPECT_TRUE(robot.granted()) << robot.reason();
}

TEST(Supervisor, SeesCommandsToDriveBetweenZeros) {
  Robot robot = guiding();
  robot.ask(Command::kStop);
  for (int i = 0; i < 5 && robot.granted(); ++i) {
    robot.command = {0.5, 0.0};
    robot.run(20);
    robot.command = {};
    robot.run(140);
  }
  EXPECT_FALSE(robot.granted());
}

TEST(Supervisor, ClearsNoHolderWhoStillDrives) {
  Robot robot = guiding();
  robot.command = {0.5, 0.0};
  robot.ask(Command::kStop);
  robot.run(500);
  EXPECT_EQ(robot.ask(Command::kClear).reason, "movement_control still commands to drive");
  robot.run(100);
  EXPECT_FALSE(robot.granted());
}

TEST(Supervisor, LetsARobotThatIsStoppedRollOutOnItsArc) {
  Robot robot = guiding();
  robot.command = robot.base.measured = {0.6, 0.4};
  robot.run(3000);
  robot.ask(Command::kStop);
  robot.command = {0.0, 0.4};
  robot.run(2400);
  EXPECT_TRUE(robot.granted()) << robot.reason();
  robot.base.measured = {};
  robot.run(40);
  robot.command = {};
  robot.run(1000);
  EXPECT_TRUE(robot.granted()) << robot.reason();
  robot.command = {0.0, 0.4};
  robot.run(500);
  EXPECT_FALSE(robot.granted()) << "it stands, and is turned";
}

TEST(Supervisor, SaysWhoStoppedTheRobot) {
  Robot robot = ready();
  robot.supervisor.request({1, "tablet", Command::kStop, ""}, robot.now());
  robot.ask(Command::kStop);
  robot.run(20);
  EXPECT_EQ(robot.reason(), "stopped by tablet, operator");
  EXPECT_EQ(robot.supervisor.status().stopped_by, (std::vector<std::string>{"tablet", "operator"}));
  EXPECT_FALSE(robot.supervisor.decision().enables.movement);
  robot.ask(Command::kMovementOn);
  robot.run(20);
  EXPECT_EQ(robot.reason(), "");
}

TEST(Supervisor, ASecondLiveClaimerIsFoundWithin100Milliseconds) {
  Robot robot = guiding();
  robot.appear(kReplacement);
  robot.run(80);
  EXPECT_EQ(robot.state(), State::kFault);
}

TEST(Supervisor, ReplacesAWriterOnlyAfterTheOldOneIsSeenDead) {
  Robot robot = guiding();
  robot.silent.insert("movement_control");  // killed
  robot.run(40);
  robot.appear(kReplacement);  // its restart
  robot.run(800);
  EXPECT_FALSE(robot.granted());
  EXPECT_NE(robot.state(), State::kFault);
  robot.supervisor.writer_gone(kDrive, kMovement);
  robot.silent.clear();
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.writer, kReplacement);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 2U);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
}

// What starts anew is heard before discovery knows that the old one died: no right to drive is the
// dead one's.
TEST(Supervisor, GrantsNothingToADeadWriterWhoseNextStartIsHeard) {
  Robot robot = guiding();
  robot.silent.insert("movement_control");
  robot.run(40);
  robot.appear(kReplacement);
  for (int ms = 0; ms < 300; ms += 20) {
    robot.supervisor.heartbeat({"movement_control", kReplacement, kDigest, Reported::kOk, ""},
                               robot.now());
    robot.run(20);
    if (ms < 60) continue;  // 100 ms after its death
    EXPECT_FALSE(robot.granted()) << ms;
    EXPECT_EQ(robot.reason(), "movement_control: starts anew");
  }
  robot.supervisor.writer_gone(kDrive, kMovement);
  robot.supervisor.heartbeat({"movement_control", kReplacement, kDigest, Reported::kOk, ""},
                             robot.now());
  robot.supervisor.step(robot.now());
  EXPECT_EQ(robot.supervisor.decision().grant.writer, kReplacement);
}

TEST(Supervisor, EpochsGrowOverARestart) {
  Robot first = ready();
  first.ask(Command::kStop);
  first.ask(Command::kEmergencyStop);
  const Memory memory = first.supervisor.memory();
  EXPECT_EQ(memory.epoch, 1U);
  ASSERT_EQ(memory.latched.size(), 1U);

  Robot second(parameters(), memory);
  second.appear();
  second.run(1000);
  EXPECT_EQ(second.state(), State::kFault) << "a restart clears nothing";
  EXPECT_TRUE(second.supervisor.decision().emergency_stop);
  EXPECT_TRUE(second.ask(Command::kClear).done);
  second.run(300);
  EXPECT_TRUE(second.granted());
  EXPECT_GT(second.supervisor.decision().grant.epoch, memory.epoch + 1);
  EXPECT_EQ(second.state(), State::kInteraction);
  EXPECT_FALSE(second.supervisor.decision().enables.movement) << "nor does it end a stop";
}

TEST(Supervisor, CountsHeartbeatsThatTheManifestDoesNotKnow) {
  Robot robot = ready();
  robot.supervisor.heartbeat({"rogue", {}, kDigest, Reported::kOk, ""}, robot.now());
  EXPECT_EQ(robot.supervisor.unknown_heartbeats(), 1U);
}

TEST(Supervisor, LooksUpWhereSomebodyStandsBeforeItAndDownWhereItDrives) {
  const Parameters angles = parameters();
  Robot robot;
  robot.run(100);
  const auto expect = [&](State state, double angle) {
    EXPECT_EQ(robot.state(), state);
    EXPECT_EQ(robot.supervisor.decision().camera_angle, angle) << text(state);
    EXPECT_EQ(robot.supervisor.status().camera_angle, angle) << text(state);
  };
  expect(State::kInitialise, angles.camera_angle_default);
  robot.appear();
  robot.run(400);
  expect(State::kInteraction, angles.camera_angle_interaction);
  robot.ask(Command::kNavigationStart, "am218");
  expect(State::kInactive, angles.camera_angle_default);
  robot.run(300);
  expect(State::kNavigationStart, angles.camera_angle_interaction);
  robot.ask(Command::kNavigationGo);
  robot.supervisor.navigation(41, GoalState::kActive);
  robot.run(100);
  expect(State::kNavigationActive, angles.camera_angle_navigation);
  robot.supervisor.navigation(41, GoalState::kSucceeded);
  robot.run(20);
  expect(State::kNavigationEnd, angles.camera_angle_interaction);
  robot.ask(Command::kManualOn);
  robot.run(300);
  expect(State::kManual, angles.camera_angle_navigation);
  robot.ask(Command::kEmergencyStop);
  expect(State::kFault, angles.camera_angle_default);
}

TEST(Supervisor, ReportsAppendixA3) {
  Robot robot = guiding();
  robot.silent.insert("tablet");
  robot.run(400);
  const SupervisorStatus status = robot.supervisor.status();
  EXPECT_EQ(status.timeout_movement, milliseconds(100));
  EXPECT_EQ(status.timeout_interaction, milliseconds(300));
  EXPECT_EQ(status.timeout_power, milliseconds(150));
  EXPECT_EQ(status.process_rate, 50.0);
  EXPECT_NEAR(status.camera_angle_interaction, 0.1745, 1e-4);
  EXPECT_NEAR(robot.supervisor.decision().camera_angle, -0.0873, 1e-4);
  EXPECT_EQ(status.state, State::kNavigationActive);
  EXPECT_EQ(status.current_goal, "am218");
  EXPECT_EQ(status.navigation, GoalState::kActive);
  EXPECT_TRUE(status.ok_movement && status.connected_movement);
  EXPECT_TRUE(status.ok_interaction && status.connected_interaction);
  EXPECT_FALSE(status.ok_power || status.connected_power) << "the base tells no charge";
  EXPECT_FALSE(status.connected_gui);
  EXPECT_TRUE(status.enables.movement && status.enables.navigation);
  EXPECT_FALSE(status.enables.manual || status.enables.interaction);
  EXPECT_TRUE(status.granted);
  EXPECT_EQ(status.epoch, 1U);
  EXPECT_EQ(status.components.size(), 6U);
  EXPECT_EQ(status.components[5].name, "tablet");
  EXPECT_EQ(status.components[5].health, Health::kMissing);
}

TEST(Supervisor, MoreStopsThanItRemembersHoldUntilAnOperatorEndsThem) {
  Robot robot = guiding();
  const auto ask_as = [&](const std::string& client, Command command) {
    robot.supervisor.request({++robot.request_id, client, command, ""}, robot.now());
    return robot.supervisor.step(robot.now()).enables.movement;
  };
  for (int i = 0; i < 40; ++i) ask_as("client " + std::to_string(i), Command::kStop);
  bool moves = false;
  for (int i = 0; i < 40; ++i)
    moves = moves || ask_as("client " + std::to_string(i), Command::kMovementOn);
  EXPECT_FALSE(moves);
  EXPECT_FALSE(ask_as("others", Command::kMovementOn));
  EXPECT_EQ(robot.supervisor.status().stopped_by, std::vector<std::string>{"others"});
  EXPECT_TRUE(ask_as("operator", Command::kMovementOn));
}

}  // namespace
}  // namespace usher::supervisor
