#include "sensing/depth_pipeline/core/tilt_history.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace usher::depth_pipeline {
namespace {

using std::chrono::milliseconds;

/// At -5 deg until 100 ms, 0.1 rad from 200 ms on, somewhere between at 150 ms.
TiltHistory turn() {
  TiltHistory history;
  int at = 0;
  for (const double servo : {-0.087, -0.087, -0.087, 0.01, 0.1, 0.1}) {
    EXPECT_TRUE(history.add(milliseconds(at), servo));
    at += 50;
  }
  return history;
}

TEST(TiltHistory, KnowsNothingBeforeTwoReadingsNorBeforeTheFirst) {
  TiltHistory history;
  EXPECT_FALSE(history.reaches(milliseconds(0)));
  history.add(milliseconds(50), 0.1);
  EXPECT_FALSE(history.reaches(milliseconds(60)));
  EXPECT_FALSE(history.turns());
  history.add(milliseconds(100), 0.1);
  EXPECT_TRUE(history.reaches(milliseconds(50)));
  EXPECT_FALSE(history.reaches(milliseconds(49)));
  EXPECT_FALSE(history.at(milliseconds(49)).has_value());
}

TEST(TiltHistory, GivesTheTiltOfATimeWhenTheReadingsAroundItAgree) {
  const TiltHistory history = turn();
  EXPECT_EQ(history.at(milliseconds(20)), -0.087);
  EXPECT_EQ(history.at(milliseconds(99)), -0.087);
  EXPECT_EQ(history.at(milliseconds(200)), 0.1);
  EXPECT_EQ(history.at(milliseconds(230)), 0.1);
}

TEST(TiltHistory, GivesNoneBetweenReadingsOfATurn) {
  const TiltHistory history = turn();
  for (const int at : {100, 101, 149, 150, 199})
    EXPECT_FALSE(history.at(milliseconds(at)).has_value()) << at;
}

TEST(TiltHistory, TrustsTheNewestReadingsThatAgreeForAllTimeAfterThem) {
  const TiltHistory history = turn();
  EXPECT_FALSE(history.turns());
  EXPECT_EQ(history.at(milliseconds(250)), 0.1);
  EXPECT_EQ(history.at(milliseconds(9000)), 0.1);
  TiltHistory turning = turn();
  turning.add(milliseconds(300), 0.12);
  EXPECT_TRUE(turning.turns());
  EXPECT_FALSE(turning.at(milliseconds(9000)).has_value());
  EXPECT_EQ(turning.newest(), 0.12);
}

TEST(TiltHistory, RefusesWhatIsNotFiniteOrNotNewer) {
  TiltHistory history = turn();
  EXPECT_FALSE(history.add(milliseconds(300), std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(history.add(milliseconds(250), 0.0));
  EXPECT_FALSE(history.add(milliseconds(10), 0.0));
  EXPECT_EQ(history.at(milliseconds(250)), 0.1);
}

TEST(TiltHistory, ForgetsWhatIsOlderThanItsCapacity) {
  TiltHistory history;
  for (int i = 0; i < 40; ++i) history.add(milliseconds(50 * i), 0.0);
  EXPECT_TRUE(history.reaches(milliseconds(50 * 24)));
  EXPECT_FALSE(history.reaches(milliseconds(50 * 24 - 1)));
}

}  // namespace
}  // namespace usher::depth_pipeline
