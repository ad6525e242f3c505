#include "operations/people_study/tracking_judge.hpp"

#include <gtest/gtest.h>

namespace usher::people_study {
namespace {

using Truth = TrackingJudge::Truth;
using Told = TrackingJudge::Told;

TEST(TrackingJudge, CountsMissesFalseAlarmsAndErrors) {
  TrackingJudge judge;
  const std::vector<Truth> truths{
      {{0, 0}, true, true}, {{3, 0}, true, true}, {{6, 0}, true, false}};
  judge.take(truths, std::vector<Told>{{1, {0.1, 0}, true}, {2, {9, 0}, true}});
  EXPECT_EQ(judge.figures().truths, 2);
  EXPECT_EQ(judge.figures().misses, 1);
  EXPECT_EQ(judge.figures().false_alarms, 1);
  EXPECT_DOUBLE_EQ(judge.figures().mota(), 0.0);
  EXPECT_NEAR(judge.figures().motp(), 0.1, 1e-9);
}

TEST(TrackingJudge, WhoIsNotSeenIsNoFalseAlarmAndNorIsASecondOneBesideSomebody) {
  TrackingJudge judge;
  judge.take(std::vector<Truth>{{{0, 0}, true, true}},
             std::vector<Told>{{1, {0, 0}, true}, {2, {0.5, 0}, true}, {3, {5, 0}, false}});
  EXPECT_EQ(judge.figures().false_alarms, 0);
}

TEST(TrackingJudge, APersonKeepsTheTrackWhileItFits) {
  TrackingJudge judge;
  const std::vector<Truth> one{{{0, 0}, true, true}};
  judge.take(one, std::vector<Told>{{1, {0.3, 0}, true}});
  judge.take(one, std::vector<Told>{{1, {0.6, 0}, true}, {2, {0, 0}, true}});
  EXPECT_EQ(judge.figures().switches, 0);
  EXPECT_EQ(judge.identity_now(0), 1U);
}

TEST(TrackingJudge, TwoWhoChangeTheirIdentitiesAreTwoSwitches) {
  TrackingJudge judge;
  const std::vector<Truth> apart{{{0, 0}, true, true}, {{3, 0}, true, true}};
  judge.take(apart, std::vector<Told>{{1, {0, 0}, true}, {2, {3, 0}, true}});
  judge.take(apart, std::vector<Told>{{2, {0, 0}, true}, {1, {3, 0}, true}});
  EXPECT_EQ(judge.figures().switches, 2);
  EXPECT_EQ(judge.figures().away_switches, 0);
  EXPECT_EQ(judge.figures_of(0).switches, 1);
}

TEST(TrackingJudge, TellsWhoWasInNoViewFromWhoWasHidden) {
  const std::vector<Truth> seen{{{0, 0}, true, true}};
  for (const bool in_view : {true, false}) {
    TrackingJudge judge;
    judge.take(seen, std::vector<Told>{{1, {0, 0}, true}});
    judge.take(std::vector<Truth>{{{0, 0}, in_view, false}}, {});
    EXPECT_EQ(judge.identity_now(0), 0U);
    judge.take(seen, std::vector<Told>{{5, {0, 0}, true}});
    EXPECT_EQ(judge.figures().switches, 1);
    EXPECT_EQ(judge.figures().away_switches, in_view ? 0 : 1);
    EXPECT_EQ(judge.figures().truths, 2);
  }
}

}  // namespace
}  // namespace usher::people_study
