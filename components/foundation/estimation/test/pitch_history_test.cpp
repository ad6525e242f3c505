#include "foundation/estimation/pitch_history.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace usher::estimation {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

TEST(PitchHistory, KnowsNothingAtFirst) {
  EXPECT_THAT(PitchHistory().at(milliseconds(0)).error(), HasSubstr("no pitch"));
}

TEST(PitchHistory, FollowsASwingBetweenItsSamples) {
  const auto angle = [](double t) { return 0.16 * std::sin(6.0 * t); };
  const auto rate = [](double t) { return 0.96 * std::cos(6.0 * t); };
  PitchHistory history;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.01 * i;
    ASSERT_TRUE(history.add(milliseconds(10 * i), {angle(t), rate(t)}).ok());
  }
  for (int ms = 0; ms < 990; ++ms) {
    const auto pitch = history.at(milliseconds(ms));
    ASSERT_TRUE(pitch.ok());
    EXPECT_NEAR(pitch->angle, angle(1e-3 * ms), 1e-6);
    EXPECT_NEAR(pitch->rate, rate(1e-3 * ms), 1e-3);
  }
}

TEST(PitchHistory, ExtrapolatesBy20MillisecondsAndNoMore) {
  PitchHistory history;
  ASSERT_TRUE(history.add(milliseconds(100), {0.1, 0.5}).ok());
  EXPECT_NEAR(history.at(milliseconds(110))->angle, 0.105, 1e-12);
  EXPECT_TRUE(history.at(milliseconds(120)).ok());
  EXPECT_THAT(history.at(milliseconds(121)).error(), HasSubstr("too old"));
}

TEST(PitchHistory, ForgetsAndSaysSo) {
  PitchHistory history;
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(history.add(milliseconds(10 * i), {0.0, 0.0}).ok());
  EXPECT_EQ(history.size(), PitchHistory::kCapacity);
  EXPECT_TRUE(history.at(milliseconds(10 * (300 - 128))).ok());
  EXPECT_THAT(history.at(milliseconds(10)).error(), HasSubstr("remembered"));
}

TEST(PitchHistory, DrawsNoLineOverAGap) {
  PitchHistory history;
  ASSERT_TRUE(history.add(milliseconds(0), {}).ok());
  ASSERT_TRUE(history.add(milliseconds(150), {}).ok());
  EXPECT_THAT(history.at(milliseconds(70)).error(), HasSubstr("gap of 150 ms"));
  EXPECT_TRUE(history.at(milliseconds(0)).ok()) << "a sample's own time";
}

TEST(PitchHistory, RefusesNonsense) {
  PitchHistory history;
  ASSERT_TRUE(history.add(milliseconds(10), {}).ok());
  EXPECT_FALSE(history.add(milliseconds(10), {}).ok());
  EXPECT_FALSE(history.add(milliseconds(5), {}).ok());
  EXPECT_FALSE(history.add(milliseconds(20), {std::nan(""), 0.0}).ok());
  EXPECT_FALSE(history.add(milliseconds(20), {0.0, INFINITY}).ok());
  EXPECT_FALSE(history.add(milliseconds(20), {2.0, 0.0}).ok());
  EXPECT_EQ(history.size(), 1U);
}

}  // namespace
}  // namespace usher::estimation
