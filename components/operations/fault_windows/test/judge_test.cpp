// Each law of the judge: it holds for what a well-behaved robot does, and it is broken by what that
// one must never do.
#include "operations/fault_windows/judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace usher::operations {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint8_t kActive = 1, kSucceeded = 3, kFailed = 4;

WindowJudge::Writer writer(std::uint8_t number) {
  WindowJudge::Writer writer{};
  writer[11] = number;
  return writer;
}

/// A robot that drives straight on, by the book, until a test lets it do something else.
class Judge : public testing::Test {
 protected:
  /// So many rounds of 20 ms.
  void run(int rounds) {
    for (int i = 0; i < rounds; ++i) round();
  }
  void run_for(double seconds) { run(static_cast<int>(std::lround(seconds / 0.02))); }

  void round() {
    t += 0.02;
    x += 0.02 * speed;
    if (supervisor_speaks) {
      judge.grant(t, false, granted, holder, epoch);
      judge.enable(t, {false, false, false, granted});
      judge.told(t, lines);
    }
    judge.limit(t, limit);
    if (wishes) judge.wish(t, 3, {wished, 0.0});
    judge.chosen(t, {commanded, 0.0});
    judge.command(t, commander, command_epoch, ++number, {commanded, 0.0});
    if (base_speaks) judge.wheels(t, {wheels, 0.0});
    judge.truth(t, {x, 0.0, yaw += 0.02 * turn_rate}, {speed, turn_rate}, contacts, "desk");
  }
  void command(double v) { wished = commanded = wheels = v; }
  void stand() {
    command(0.0);
    speed = 0.0;
  }
  std::string violation() { return judge.judgement(t).violation; }

  WindowJudge judge;
  double t = 0.0, x = 0.0, yaw = 0.0, turn_rate = 0.0;
  double speed = 0.5, wished = 0.5, commanded = 0.5, wheels = 0.5, limit = 1.0;
  WindowJudge::Writer holder = writer(1), commander = writer(1);
  std::uint64_t epoch = 7, command_epoch = 7, number = 0;
  std::uint32_t contacts = 0;
  bool supervisor_speaks = true, granted = true, wishes = true, base_speaks = true;
  std::vector<std::string> lines;
};

TEST_F(Judge, FindsNothingWrongWithARobotThatDrives) {
  run_for(10.0);
  EXPECT_THAT(violation(), IsEmpty());
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kDrives);
}

TEST_F(Judge, SwayingInOnePlaceIsNotDriving) {
  run_for(2.0);
  command(0.0);
  for (int i = 0; i < 16; ++i) {
    speed = i % 2 == 0 ? 0.04 : -0.04;  // 32 cm of way in eight seconds, 2 cm from place to place
    run_for(0.5);
  }
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kUnexplained);
  EXPECT_THAT(violation(), HasSubstr("nobody says why"));
}

TEST_F(Judge, ALittleWayAndALittleTurnAreDriving) {
  run_for(2.0);
  stand();
  run_for(9.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kUnexplained);
  command(0.02);
  speed = 0.02;
  run_for(4.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kUnexplained) << "8 cm";
  turn_rate = 0.035;
  run_for(3.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kDrives) << "14 cm and 0.1 rad";
}

TEST_F(Judge, SeesAContact) {
  run_for(1.0);
  contacts = 1;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("contact with 'desk'"));
}

TEST_F(Judge, CountsWhatADeafBaseTouchesApart) {
  run_for(1.0);
  judge.hit(t, {{.deaf = true, .lasts = 0.5, .words = {}}});
  contacts = 1;
  run_for(1.0);
  EXPECT_THAT(violation(), IsEmpty());
  EXPECT_EQ(judge.judgement(t).deaf_contacts, 1U);
  run_for(4.0);
  contacts = 2;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("contact with 'desk'")) << "it has been told to stand since";
}

TEST_F(Judge, SeesWheelsThatAreToldToMoveWithoutAGrant) {
  run_for(1.0);
  supervisor_speaks = false;
  run_for(0.12);
  EXPECT_THAT(violation(), IsEmpty()) << "the last grant still lives";
  run_for(0.06);
  EXPECT_THAT(violation(), HasSubstr("without a live grant"));
}

TEST_F(Judge, SeesWheelsThatGoOnAfterAWithdrawal) {
  run_for(1.0);
  granted = false;
  run(1);
  EXPECT_THAT(violation(), IsEmpty()) << "it is on its way to the base";
  run(2);
  EXPECT_THAT(violation(), HasSubstr("without a live grant"));
}

TEST_F(Judge, SeesWheelsThatDriveWhatNobodyCommanded) {
  run_for(1.0);
  wheels = 0.6;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("did not command"));
}

TEST_F(Judge, SeesTheWheelsObeyAForeignWriter) {
  run_for(1.0);
  commander = writer(9);
  run_for(0.3);
  EXPECT_THAT(violation(), HasSubstr("did not command"));
}

TEST_F(Judge, SeesTheWheelsObeyAnotherEpoch) {
  run_for(1.0);
  command_epoch = 6;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("did not command"));
}

TEST_F(Judge, SeesTheWheelsObeyARepetition) {
  run_for(1.0);
  number -= 10;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("did not command"));
}

TEST_F(Judge, SeesTheWheelsObeyWhatIsNotFiniteOrTooFast) {
  run_for(1.0);
  judge.command(t, holder, epoch, ++number, {std::numeric_limits<double>::quiet_NaN(), 0.0});
  judge.wheels(t, {0.5, 0.0});
  EXPECT_THAT(violation(), HasSubstr("did not command")) << "it ends the one before it";
  WindowJudge other;
  other.grant(0.0, false, true, holder, epoch);
  other.command(0.0, holder, epoch, 1, {5.0, 0.0});
  other.wheels(0.0, {5.0, 0.0});
  EXPECT_THAT(other.judgement(0.0).violation, HasSubstr("did not command"));
}

TEST_F(Judge, TakesNoGrantOfAForeignWriter) {
  run_for(1.0);
  supervisor_speaks = false;
  for (int i = 0; i < 10; ++i) {
    judge.grant(t, true, true, holder, epoch);
    round();
  }
  EXPECT_THAT(violation(), HasSubstr("without a live grant"));
}

TEST_F(Judge, SeesARobotThatRollsOnWithoutAGrant) {
  run_for(1.0);
  supervisor_speaks = false;
  command(0.0);
  run_for(1.4);
  EXPECT_THAT(violation(), IsEmpty()) << "within d(v) and what is measured of it";
  run_for(1.0);
  EXPECT_THAT(violation(), HasSubstr("without a grant: "));
}

TEST_F(Judge, SeesARobotThatCreepsWithoutAGrant) {
  run_for(1.0);
  supervisor_speaks = false;
  stand();
  run_for(3.0);
  speed = 0.06;
  run_for(5.0);
  EXPECT_THAT(violation(), HasSubstr("without a grant"));
}

TEST_F(Judge, LetsARollingRobotStayOnItsArc) {
  run_for(1.0);
  supervisor_speaks = false;
  judge.truth(t, {x, 0.0, 0.0}, {0.5, 0.4}, 0, "");
  judge.wheels(t + 0.2, {0.0, 0.4});
  EXPECT_THAT(violation(), IsEmpty());
  WindowJudge other = judge;
  judge.wheels(t + 0.2, {0.0, 0.6});
  EXPECT_THAT(violation(), HasSubstr("without a live grant")) << "faster than it turned";
  other.wheels(t + 0.2, {0.0, -0.4});
  EXPECT_THAT(other.judgement(t).violation, HasSubstr("without a live grant")) << "the other way";
}

TEST_F(Judge, SeesATurnOnTheSpotWithoutAGrant) {
  stand();
  run_for(4.0);
  judge.wheels(t + 1.0, {0.0, 0.05});
  EXPECT_THAT(violation(), HasSubstr("without a live grant"));
}

TEST_F(Judge, SeesACommandThatNobodyWished) {
  run_for(1.0);
  commanded = wheels = 0.6;
  run(1);
  EXPECT_THAT(violation(), HasSubstr("no enabled source wished"));
}

TEST_F(Judge, SeesACommandThatOutlivesItsWish) {
  run_for(1.0);
  wishes = false;
  run_for(0.9);
  EXPECT_THAT(violation(), IsEmpty()) << "it may still be ramped down";
  run_for(0.3);
  EXPECT_THAT(violation(), HasSubstr("no enabled source wished"));
}

TEST_F(Judge, CountsNoWishOfASourceThatIsNotEnabled) {
  stand();
  run_for(2.0);
  judge.wish(t, 1, {0.5, 0.0});
  judge.chosen(t, {0.5, 0.0});
  EXPECT_THAT(violation(), HasSubstr("no enabled source wished"));
}

TEST_F(Judge, SeesACommandBeyondItsLimit) {
  run_for(1.0);
  limit = 0.4;
  run_for(0.9);
  EXPECT_THAT(violation(), IsEmpty()) << "the ramp takes its time";
  run_for(0.5);
  EXPECT_THAT(violation(), HasSubstr("the limit is 0.40"));
}

TEST_F(Judge, SeesARobotThatDrivesThroughAFault) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 2.0, .words = {}}});
  run_for(0.18);
  EXPECT_THAT(violation(), IsEmpty());
  run_for(0.1);
  EXPECT_THAT(violation(), HasSubstr("still told"));
}

TEST_F(Judge, SeesARightThatIsNotRevoked) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .revoked_within = 0.3, .lasts = 5.0, .words = {}}});
  stand();
  run_for(0.28);
  EXPECT_THAT(violation(), IsEmpty());
  run_for(0.1);
  EXPECT_THAT(violation(), HasSubstr("granted still"));
}

TEST_F(Judge, ExpectsNothingAfterTheFault) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 0.15, .words = {}}});
  run_for(10.0);
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, WhatComesAsTheFaultEndsComesThrough) {
  run_for(1.0);
  stand();
  judge.hit(t, {{.zero_within = 0.2, .lasts = 1.0, .words = {}}});
  run_for(0.98);
  command(0.2);
  run_for(0.02);
  EXPECT_THAT(violation(), IsEmpty());
  judge.hit(t, {{.zero_within = 0.2, .lasts = 1.0, .words = {}}});
  run_for(0.96);
  EXPECT_THAT(violation(), HasSubstr("still told"));
}

TEST_F(Judge, WaitsUntilASilentDriversBaseLetsGo) {
  run_for(1.0);
  base_speaks = false;
  judge.hit(t, {{.zero_within = 0.45, .lasts = 5.0, .words = {}}});
  run_for(0.4);
  stand();
  run_for(2.0);
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, WantsTheReasonToNameTheThing) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 12.0, .words = {"lms100", "scan"}}});
  stand();
  run_for(1.0);
  lines = {"amcl: silent"};
  run_for(1.6);
  EXPECT_THAT(violation(), HasSubstr("does not read 'lms100': 'amcl: silent'"));
}

TEST_F(Judge, WantsOneOfTwoThingsToBeNamed) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 12.0, .words = {"lms100"}},
                {.zero_within = 0.2, .lasts = 12.0, .words = {"rogue"}}});
  stand();
  lines = {"foreign writer: rogue"};
  run_for(9.0);
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, TakesWhatHasJustEndedForTheReason) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 4.0, .words = {"base"}},
                {.zero_within = 0.2, .lasts = 12.0, .words = {"command"}}});
  stand();
  lines = {"segway_rmp: the base is silent"};
  run_for(4.0);
  lines = {"amcl: no scan"};
  run_for(2.0);
  EXPECT_THAT(violation(), IsEmpty());
  run_for(1.0);
  EXPECT_THAT(violation(), HasSubstr("does not read 'command'"));
}

TEST_F(Judge, ReadsTheReasonOfTheNavigation) {
  run_for(1.0);
  judge.navigation(t, kActive, "no word from the odometry");
  judge.hit(t, {{.zero_within = 0.2, .lasts = 12.0, .words = {"odom"}}});
  stand();
  run_for(9.0);
  judge.navigation(t, kActive, "no word from the odometry");
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, WantsNoReasonOfARobotThatArrived) {
  run_for(1.0);
  judge.navigation(t, kSucceeded, "");
  judge.hit(t, {{.zero_within = 0.2, .lasts = 12.0, .words = {"odom"}}});
  stand();
  run_for(9.0);
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, ReadsTheReason) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 12.0, .words = {"lms100"}}});
  stand();
  lines = {"amcl: silent", "lms100: silent"};
  run_for(9.0);
  EXPECT_THAT(violation(), IsEmpty());
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kStands);
  EXPECT_EQ(judge.judgement(t).reason, "amcl: silent");
}

TEST_F(Judge, CountsNoReasonThatWasThereBeforeTheHit) {
  lines = {"gamepad: no pad"};
  run_for(1.0);
  judge.hit(t, {});
  stand();
  run_for(9.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kUnexplained);
  EXPECT_THAT(violation(), HasSubstr("nobody says why"));
}

TEST_F(Judge, ReadsThatTheSupervisorIsSilent) {
  run_for(1.0);
  judge.hit(t, {{.zero_within = 0.2, .lasts = 20.0, .words = {"supervisor"}}});
  supervisor_speaks = false;
  stand();
  run_for(9.0);
  EXPECT_THAT(violation(), IsEmpty());
  EXPECT_EQ(judge.judgement(t).reason, "supervisor: silent");
}

TEST_F(Judge, SeesTheWayForwardAgainstAWhisker) {
  run_for(1.0);
  judge.hit(t, {{.forward_barred_within = 0.1, .lasts = 20.0, .words = {}}});
  run_for(1.5);
  EXPECT_THAT(violation(), IsEmpty());
  run_for(1.0);
  EXPECT_THAT(violation(), HasSubstr("against the whiskers"));
}

TEST_F(Judge, LetsItBackOffFromAWhisker) {
  run_for(1.0);
  judge.hit(t, {{.forward_barred_within = 0.1, .lasts = 20.0, .words = {}}});
  command(-0.2);
  speed = -0.2;
  run_for(10.0);
  EXPECT_THAT(violation(), IsEmpty());
}

TEST_F(Judge, TellsHowTheNavigationEnded) {
  run_for(1.0);
  stand();
  run_for(9.0);
  judge.navigation(t, kActive, "waits for a person");
  judge.navigation(t, kActive, "");
  run_for(4.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kWaits) << "a creeping robot waits now and then";
  run_for(5.0);
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kUnexplained);
  judge.navigation(t, kFailed, "no way");
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kGaveUp);
  EXPECT_EQ(judge.judgement(t).reason, "no way");
  judge.navigation(t, kSucceeded, "");
  EXPECT_EQ(judge.judgement(t).end, WindowEnd::kArrived);
}

}  // namespace
}  // namespace usher::operations
