#include "operations/experiments/follow_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::operations {
namespace {

class Follow : public testing::Test {
 protected:
  void pass(double seconds, double gap, bool waits = false, bool visible = true) {
    for (int i = 0; i < std::lround(seconds * 10.0); ++i)
      judge.take({t += 0.1, !waits, waits, gap, visible});
  }
  FollowJudge judge;
  double t = 0.0;
};

TEST_F(Follow, OneWhoFollowsIsNeverLost) {
  pass(20.0, 1.5);
  judge.finish();
  EXPECT_TRUE(judge.losses().empty());
  EXPECT_EQ(judge.largest_gap(), 1.5);
  EXPECT_EQ(judge.waits(), 0U);
}

TEST_F(Follow, ALossLastsUntilTheGuideWaits) {
  pass(5.0, 1.5);
  pass(1.5, 4.5);
  pass(10.0, 6.5, true);
  pass(5.0, 1.5);
  ASSERT_EQ(judge.losses().size(), 1U);
  EXPECT_NEAR(judge.losses()[0], 1.5, 0.11);
  EXPECT_EQ(judge.largest_gap(), 4.5) << "while it waits the visitor may be anywhere";
  EXPECT_NEAR(judge.waited(), 10.0, 0.11);
  EXPECT_EQ(judge.waits(), 1U);
  EXPECT_EQ(judge.needless_waits(), 0U);
}

TEST_F(Follow, AWallHidesTheVisitor) {
  pass(5.0, 1.5);
  pass(1.0, 2.0, false, false);
  pass(1.0, 2.0, true, false);
  ASSERT_EQ(judge.losses().size(), 1U);
  EXPECT_NEAR(judge.losses()[0], 1.0, 0.11);
}

TEST_F(Follow, AShortLossThatEndsByItselfIsNone) {
  pass(1.8, 2.0, false, false);
  pass(5.0, 2.0);
  judge.finish();
  EXPECT_TRUE(judge.losses().empty());
}

TEST_F(Follow, ALongLossThatNobodyNoticedCountsWhole) {
  pass(6.0, 5.0);
  pass(1.0, 1.0);
  pass(4.0, 5.0);
  judge.finish();
  ASSERT_EQ(judge.losses().size(), 2U);
  EXPECT_NEAR(judge.losses()[0], 5.9, 0.11);
  EXPECT_NEAR(judge.losses()[1], 3.9, 0.11);
}

TEST_F(Follow, WaitingForSomebodyWhoIsThereIsNeedless) {
  pass(5.0, 1.5);
  pass(3.0, 1.5, true);
  pass(5.0, 1.5);
  EXPECT_EQ(judge.needless_waits(), 1U);
}

TEST_F(Follow, BrakingCountsAsDriving) {
  pass(1.0, 4.2);
  for (int i = 0; i < 10; ++i) judge.take({t += 0.1, true, true, 5.0, true});
  EXPECT_EQ(judge.largest_gap(), 4.2);
  EXPECT_EQ(judge.largest_gap_driving(), 5.0);
}

}  // namespace
}  // namespace usher::operations
