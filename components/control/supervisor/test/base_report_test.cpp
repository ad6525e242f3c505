// What the supervisor makes of the base's reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "control/supervisor/test/robot.hpp"

namespace usher::supervisor {
namespace {

TEST(Supervisor, NobodyDrivesABaseThatWasNeverHeard) {
  Robot robot;
  robot.base_unheard = true;
  robot.appear();
  robot.run(1000);
  EXPECT_EQ(robot.state(), State::kInitialise);
  EXPECT_FALSE(robot.granted());
  EXPECT_EQ(robot.reason(), "segway_rmp: no base/status yet");
  robot.base_unheard = false;
  robot.run(400);
  EXPECT_TRUE(robot.granted());
}

TEST(Supervisor, TellsOfThePowerWhatTheBaseSaysOfItsBattery) {
  Robot robot = ready();
  const auto power = [&](double battery_percent) {
    robot.base.battery_percent = battery_percent;
    robot.run(200);
    const SupervisorStatus status = robot.supervisor.status();
    return std::pair(status.connected_power, status.ok_power);
  };
  EXPECT_EQ(power(80.0), std::pair(true, true));
  EXPECT_EQ(power(0.0), std::pair(true, false));
  EXPECT_EQ(power(std::numeric_limits<double>::quiet_NaN()), std::pair(false, false));
  robot.base_unheard = true;
  EXPECT_EQ(power(80.0), std::pair(false, false));
  robot.base_unheard = false;
  EXPECT_EQ(power(80.0), std::pair(true, true));
}

TEST(Supervisor, ClearsABaseOutOfItsEmergency) {
  Robot robot = ready();
  robot.base.emergency = true;
  robot.run(100);
  EXPECT_TRUE(robot.ask(Command::kClear).done);
  EXPECT_TRUE(robot.supervisor.decision().reset_base);
  EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
  EXPECT_FALSE(robot.granted()) << "not before the base stands again";
  robot.run(1000);
  EXPECT_TRUE(robot.supervisor.decision().reset_base);
  robot.base.emergency = false;
  robot.run(300);
  EXPECT_FALSE(robot.supervisor.decision().reset_base);
  EXPECT_TRUE(robot.granted());
}

TEST(Supervisor, AsksABaseThatIsOffAgainToStandUp) {
  Robot robot = ready();
  robot.base.ready = false;
  robot.run(100);
  EXPECT_FALSE(robot.supervisor.decision().reset_base) << "not by itself";
  EXPECT_TRUE(robot.ask(Command::kClear).done);
  EXPECT_TRUE(robot.supervisor.decision().reset_base);
  robot.run(6000);  // it lies
  EXPECT_FALSE(robot.supervisor.decision().reset_base);
  EXPECT_TRUE(robot.ask(Command::kClear).done);
  EXPECT_TRUE(robot.supervisor.decision().reset_base);
  robot.base.ready = true;
  robot.run(300);
  EXPECT_FALSE(robot.supervisor.decision().reset_base);
  EXPECT_TRUE(robot.granted()) << robot.reason();
}

TEST(Supervisor, LatchesAnewWhenTheBaseStaysInItsEmergency) {
  Robot robot = ready();
  robot.base.emergency = true;
  robot.run(100);
  robot.ask(Command::kClear);
  robot.run(5100);
  EXPECT_EQ(robot.state(), State::kFault);
}

TEST(Supervisor, TrustsABaseThatTakesTwoSecondsToStop) {
  Robot robot = guiding();
  robot.command = {1.4, 0.0};
  robot.base.measured = {1.4, 0.0};
  robot.run(100);
  robot.command = {};
  for (int ms = 0; ms < 6000; ms += 20) {
    const double t = ms * 0.001;
    const double slow = 1.4 - 0.2 * t;
    robot.base.measured.v = t < 1.5 ? slow : std::max(1.1 - 2.8 * (t - 1.5), -0.3 * (t < 3.0));
    robot.run(20);
    ASSERT_EQ(robot.state(), State::kNavigationActive) << "after " << t << " s";
  }
}

TEST(Supervisor, ABaseThatStandsIsNoFault) {
  Robot robot = guiding();
  robot.command = {1.0, 0.0};
  robot.run(10000);
  EXPECT_EQ(robot.state(), State::kNavigationActive);
  const SupervisorStatus status = robot.supervisor.status();
  ASSERT_EQ(status.faults.size(), 1U);
  EXPECT_EQ(status.faults[0].cause, Cause::kBaseFallsShort);
  EXPECT_FALSE(status.faults[0].latched());
}

TEST(Supervisor, ALostSerialLineIsNoDisobedience) {
  Robot robot = guiding();
  robot.command = {1.0, 0.0};
  robot.base.measured = {1.0, 0.0};
  robot.run(1000);
  // The line is lost; the driver reports no speed, or the last one, for minutes.
  for (const Twist2& reported : {Twist2{}, Twist2{1.0, 0.0}, Twist2{-2.0, 3.0}}) {
    robot.base.ready = false;
    robot.base.measured = reported;
    robot.command = {};
    robot.run(60000);
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
    // It is back while the base still rolls out, two seconds long.
    robot.base.ready = true;
    for (int ms = 0; ms < 2000; ms += 20) {
      robot.base.measured = {1.2 - 0.0006 * ms, 0.0};
      robot.run(20);
    }
    robot.base.measured = {};
    robot.run(3000);
    ASSERT_EQ(robot.state(), State::kNavigationActive) << robot.reason();
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
  }
  // But it must come to what it is told.
  robot.base.ready = false;
  robot.run(100);
  robot.base.ready = true;
  robot.base.measured = {1.0, 0.0};
  robot.run(4000);
  EXPECT_EQ(robot.state(), State::kFault);
}

TEST(Supervisor, NobodyDrivesABaseThatIsNotReady) {
  Robot robot = guiding();
  robot.base.ready = false;
  robot.run(20);
  EXPECT_FALSE(robot.granted());
  EXPECT_EQ(robot.reason(), "segway_rmp: the base is disconnected or its motors are off");
  robot.run(2000);
  EXPECT_EQ(robot.state(), State::kInactive);
  robot.base.ready = true;
  robot.run(400);
  EXPECT_TRUE(robot.granted());
  EXPECT_EQ(robot.state(), State::kNavigationActive) << "the mission goes on";
}

TEST(Supervisor, AGapInTheBasesReportsProvesNoDisobedience) {
  Robot robot = guiding();
  robot.base_unheard = true;
  robot.run(5000);
  robot.base_unheard = false;
  for (int ms = 0; ms < 2000; ms += 20) {
    robot.base.measured = {1.2 - 0.0006 * ms, 0.0};
    robot.run(20);
    ASSERT_NE(robot.state(), State::kFault) << ms;
  }
  const SupervisorStatus status = robot.supervisor.status();
  ASSERT_EQ(status.faults.size(), 1U);
  EXPECT_EQ(status.faults[0].cause, Cause::kBaseUnheard);
  EXPECT_FALSE(status.faults[0].active);
}

TEST(Supervisor, WithoutAGrantTheBaseShallStand) {
  Robot robot = ready();
  robot.command = {1.0, 0.0};
  robot.base.measured = {1.0, 0.0};
  robot.run(2000);
  ASSERT_EQ(robot.state(), State::kInteraction) << "it drives as commanded";
  robot.silent.insert("amcl");
  robot.run(6000);
  EXPECT_EQ(robot.state(), State::kFault) << "it drives without the right";
  EXPECT_TRUE(robot.supervisor.decision().emergency_stop);
}

TEST(Supervisor, WhoPushesAStandingBaseDoesNotSwitchItOff) {
  for (const geometry::Twist2& push : {geometry::Twist2{0.3, 0.0}, geometry::Twist2{0.0, 0.5}}) {
    Robot robot = ready();
    robot.run(3000);
    robot.base.measured = push;
    robot.run(1500);
    EXPECT_EQ(robot.state(), State::kFault);
    EXPECT_FALSE(robot.granted());
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
    robot.base.measured = {1.2, 0.0};
    robot.run(1500);
    EXPECT_TRUE(robot.supervisor.decision().emergency_stop) << "it drives away";
    robot.base.measured = {};
    robot.run(100);
    EXPECT_TRUE(robot.supervisor.decision().emergency_stop) << "until an operator clears";
    robot.ask(Command::kClear);
    robot.run(500);
    EXPECT_FALSE(robot.supervisor.decision().emergency_stop);
    EXPECT_TRUE(robot.granted());
  }
}

TEST(Supervisor, RejectsAnOdometryThatIsNotANumber) {
  Robot robot = ready();
  robot.base.measured.v = std::numeric_limits<double>::quiet_NaN();
  robot.run(100);
  EXPECT_EQ(robot.supervisor.rejected_reports(), 5U);
}

TEST(Supervisor, ContinuesAboveTheBasesEpochWhenItsMemoryIsLost) {
  Robot robot;
  robot.base.epoch = 5000;
  robot.appear();
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 5001U);
  robot.base.epoch = 5001;
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 5001U);
  robot.base.epoch = std::numeric_limits<std::uint64_t>::max();  // nonsense is not believed
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 5001U);
}

/// A base that has just started and hears a supervisor's grant.
bool hears(const Robot& robot) {
  drive::BaseObedience base;
  base.grant(robot.supervisor.decision().grant, robot.now());
  return base.highest_epoch() == robot.supervisor.decision().grant.epoch;
}

TEST(Supervisor, WhereNobodyWatchesTheBasesEpochIsBelievedAsFarAsABaseFollows) {
  Robot robot(parameters());
  robot.appear();
  robot.run(400);
  robot.base.epoch = drive::kLongestLeap + 2;
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 1U);
  robot.base.epoch = drive::kLongestLeap + 1;
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, drive::kLongestLeap + 2);
}

TEST(Supervisor, BelievesAnEpochOfNobodyButTheBase) {
  constexpr WriterId kBase{3};
  constexpr const char* kStatus = "base/status";
  Parameters watching = parameters();
  watching.base_topic = kStatus;
  watching.topics.push_back({kStatus, {"segway_rmp"}, false});
  Robot robot(watching);
  robot.base.writer = kBase;
  robot.supervisor.writer_appeared(kStatus, {kBase, "segway_rmp", "nuc"}, robot.now());
  robot.appear();
  robot.run(400);
  ASSERT_EQ(robot.supervisor.decision().grant.epoch, 1U);

  BaseReport lie = robot.base;
  lie.writer = kRogue;
  const auto lies = [&] {
    for (lie.epoch = 1; lie.epoch < std::uint64_t{1} << 61; lie.epoch *= 8)
      robot.supervisor.base(lie, robot.now());
    robot.supervisor.step(robot.now());
  };
  lies();  // before discovery tells of its writer
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 1U);
  EXPECT_EQ(robot.supervisor.rejected_reports(), 20U) << "of 21, the epoch of one is not higher";
  for (const char* name : {"stranger", "segway_rmp"}) {
    SCOPED_TRACE(name);
    robot.supervisor.writer_appeared(kStatus, {kRogue, name, "elsewhere"}, robot.now());
    lies();
    robot.run(100);
    robot.supervisor.writer_gone(kStatus, kRogue);
    robot.ask(Command::kClear);
    robot.run(400);
    EXPECT_TRUE(robot.granted()) << robot.reason();
    EXPECT_LE(robot.supervisor.decision().grant.epoch, 3U);
    EXPECT_TRUE(hears(robot));
  }

  robot.base.epoch = 5000;
  robot.run(400);
  EXPECT_EQ(robot.supervisor.decision().grant.epoch, 5001U) << "the base itself is believed";
}

TEST(Supervisor, OfARememberedEpochABaseThatStartsAnewHearsTheNextOnes) {
  for (const std::uint64_t remembered :
       {drive::kLongestLeap, std::uint64_t{1} << 40, std::numeric_limits<std::uint64_t>::max()}) {
    Memory memory;
    memory.epoch = remembered;
    Robot robot(parameters(), memory);
    robot.appear();
    robot.run(400);
    EXPECT_TRUE(robot.granted());
    EXPECT_TRUE(hears(robot)) << remembered;
  }
}

TEST(Supervisor, TellsWhatTheBaseRefuses) {
  Robot robot = guiding();
  robot.base.refusal = "a repeated or late command";
  robot.run(280);
  EXPECT_EQ(robot.reason(), "") << "a new right takes its way to the base";
  robot.run(100);
  EXPECT_EQ(robot.reason(), "segway_rmp: a repeated or late command");
  EXPECT_TRUE(robot.granted()) << "it may still begin to speak sense";
  robot.base.refusal.clear();
  robot.run(20);
  EXPECT_EQ(robot.reason(), "");
}

TEST(Supervisor, TellsThatTheBaseFallsShort) {
  Robot robot = guiding();
  robot.command = {0.8, 0.0};
  robot.run(6000);
  EXPECT_EQ(robot.reason(), "segway_rmp: the base falls short of its command");
}

TEST(Supervisor, TellsWhatBarsANavigation) {
  Robot robot = guiding();
  const auto stand = [&](const char* why, int ms) {
    for (int at = 0; at < ms; at += 100) {
      robot.supervisor.movement(why, robot.now());
      robot.run(100);
    }
  };
  stand("a whisker is touched", 400);
  EXPECT_EQ(robot.reason(), "") << "so long everybody may stand";
  stand("a whisker is touched", 200);
  EXPECT_EQ(robot.reason(), "movement_control: a whisker is touched");
  robot.base.refusal = "a command for another epoch than the grant's";
  stand("a whisker is touched", 600);
  EXPECT_EQ(robot.reason(), "segway_rmp: a command for another epoch than the grant's")
      << "without the whisker it would not drive either";
  robot.base.refusal.clear();
  stand("", 100);
  EXPECT_EQ(robot.reason(), "");
}

TEST(Supervisor, NeedsNoReasonForARobotThatNobodyWantsToMove) {
  Robot robot = ready();
  for (int i = 0; i < 10; ++i) {
    robot.supervisor.movement("no enabled source has a fresh command", robot.now());
    robot.run(100);
  }
  EXPECT_EQ(robot.state(), State::kInteraction);
  EXPECT_EQ(robot.reason(), "");
}

}  // namespace
}  // namespace usher::supervisor
