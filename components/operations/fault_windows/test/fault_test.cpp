#include "operations/fault_windows/fault.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace usher::operations {
namespace {

const FaultTargets kTargets{
    {"supervisor", "lms100", "tablet"}, {"lms100", "segway_rmp"}, "segway_rmp", 40, 5};

TEST(DrawWindow, GivesTheSamePlanForTheSameSeedAndAttempt) {
  EXPECT_EQ(draw_window(7, 0, kTargets).text(), draw_window(7, 0, kTargets).text());
  EXPECT_NE(draw_window(7, 0, kTargets).text(), draw_window(7, 1, kTargets).text());
  EXPECT_NE(draw_window(7, 0, kTargets).text(), draw_window(8, 0, kTargets).text());
}

TEST(DrawWindow, StartsAndGoesWhereItMay) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const auto plan = draw_window(seed, 0, kTargets);
    EXPECT_LT(plan.start, kTargets.starts);
    EXPECT_LT(plan.goal, kTargets.locations);
  }
}

FaultTargets of_one_that_sees() {
  FaultTargets targets = kTargets;
  targets.sees = true;
  return targets;
}

TEST(DrawWindow, DrawsEveryKindAndTwoAtOnce) {
  for (const bool sees : {false, true}) {
    SCOPED_TRACE(sees);
    const FaultTargets targets = sees ? of_one_that_sees() : kTargets;
    std::map<std::string, int> counts;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed)
      ++counts[draw_window(seed, 0, targets).kind()];
    EXPECT_EQ(counts.size(), (sees ? kFaultKinds : kBlindFaultKinds) + 1);
    for (const auto& [kind, count] : counts) EXPECT_GE(count, 30) << kind;
  }
}

TEST(DrawWindow, LeavesTheOtherDrawsAsTheyAreWithoutDepthCameras) {
  const FaultTargets seeing = of_one_that_sees();
  int same = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const WindowPlan blind = draw_window(seed, 0, kTargets), sees = draw_window(seed, 0, seeing);
    EXPECT_EQ(blind.start, sees.start);
    EXPECT_EQ(blind.delay, sees.delay);
    EXPECT_EQ(blind.faults.size(), sees.faults.size());
    same += blind.faults.front().text() == sees.faults.front().text() ? 1 : 0;
  }
  EXPECT_NEAR(same, 500, 60);
}

TEST(DrawWindow, SpoilsEachSenseInEveryWay) {
  std::set<std::string> ways;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const auto plan = draw_window(seed, 0, of_one_that_sees());
    const Fault& fault = plan.faults.front();
    const bool sight = fault.kind == FaultKind::kDepth || fault.kind == FaultKind::kUltrasonic ||
                       fault.kind == FaultKind::kPeople;
    if (sight) ways.insert(std::string(text(fault.kind)) + " " + fault.target + fault.variant);
  }
  EXPECT_EQ(ways.size(), 9U + 3U + 3U);
}

TEST(DrawWindow, DrawsFaultsThatBeginAndEndInTheirWindow) {
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    const auto plan = draw_window(seed, 0, kTargets);
    for (const Fault& fault : plan.faults) {
      EXPECT_GT(fault.duration, 0.0) << plan.text();
      EXPECT_LE(fault.duration, kWindow) << plan.text();
    }
  }
}

TEST(ExpectationOfAFault, ForACriticalComponentAndTheSupervisorItselfIsAStopWithinThePromise) {
  for (const FaultKind kind : {FaultKind::kCrash, FaultKind::kHang}) {
    for (const char* name : {"lms100", "supervisor", "segway_rmp"}) {
      const auto expected = expectation({kind, name, "", 3.0}, kTargets);
      EXPECT_FALSE(expected.deaf) << "a guard process stands in for the base's driver";
      EXPECT_EQ(expected.zero_within, 0.2) << name;
      EXPECT_EQ(expected.lasts, 3.0);
      EXPECT_EQ(expected.words, std::vector<std::string>{name});
    }
    EXPECT_EQ(expectation({kind, "tablet", "", 3.0}, kTargets).zero_within, Expectation::kNever);
  }
}

TEST(ExpectationOfAFault, ForAForeignWriterLastsUntilTheEnd) {
  EXPECT_EQ(expectation({FaultKind::kRogue, "drive/command", "rogue", 0.2}, kTargets).lasts,
            kWindow);
}

TEST(ExpectationOfAFault, ForAFloodIsAForeignWritersWhereOnlyComponentsMayWrite) {
  const Expectation own = expectation({FaultKind::kFlood, "tf", "", 0.2}, kTargets);
  EXPECT_EQ(own.zero_within, 0.1);
  EXPECT_EQ(own.lasts, kWindow);
  EXPECT_EQ(own.words, std::vector<std::string>{kFlooder});
  EXPECT_EQ(expectation({FaultKind::kFlood, "heartbeat", "", 0.2}, kTargets).zero_within,
            Expectation::kNever);
}

TEST(ExpectationOfAFault, ForADeafBaseIsThatItLetsGoByItself) {
  EXPECT_TRUE(expectation({FaultKind::kBaseLink, "", "commands", 3.0}, kTargets).deaf);
  EXPECT_FALSE(expectation({FaultKind::kBaseLink, "", "feedback", 3.0}, kTargets).deaf);
  WindowPlan plan;
  plan.faults = {{FaultKind::kBaseLink, "", "commands", 3.0},
                 {FaultKind::kHang, "lms100", "", 3.0},
                 {FaultKind::kFlood, "heartbeat", "", 3.0}};
  const auto all = expectations(plan, kTargets);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_GT(all[1].zero_within, 0.4) << "zero is said, and nobody hears it";
  EXPECT_EQ(all[2].zero_within, Expectation::kNever);
}

TEST(ExpectationOfAFault, ForATouchThatNobodyTellsOfIsNothing) {
  WindowPlan plan;
  plan.faults = {{FaultKind::kTopicSilence, "whiskers", "", 20.0},
                 {FaultKind::kWhiskers, "", "pressed", 5.0}};
  const auto all = expectations(plan, kTargets);
  EXPECT_EQ(all[1].forward_barred_within, Expectation::kNever);
  EXPECT_LT(all[0].zero_within, 1.0) << "but it stands";
  plan.faults.erase(plan.faults.begin());
  EXPECT_LT(expectations(plan, kTargets)[0].forward_barred_within, 1.0);
}

TEST(ExpectationOfAFault, BesideASilentSupervisorIsThatTheGrantRunsOut) {
  WindowPlan plan;
  plan.faults = {{FaultKind::kHang, "supervisor", "", 3.0},
                 {FaultKind::kRogue, "cmd_vel/navigation", "rogue", 4.0}};
  const auto all = expectations(plan, kTargets);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].zero_within, all[0].zero_within);
  const Expectation alone = expectation(plan.faults[1], kTargets);
  EXPECT_LT(alone.zero_within, all[1].zero_within);
  EXPECT_EQ(all[1].read_within, alone.read_within + 3.0) << "nobody tells why until it is back";
  EXPECT_EQ(all[0].read_within, alone.read_within);
  plan.faults[1].duration = 2.0;
  EXPECT_EQ(expectations(plan, kTargets)[1].revoked_within, Expectation::kNever)
      << "came and went while nobody watched";
}

}  // namespace
}  // namespace usher::operations
