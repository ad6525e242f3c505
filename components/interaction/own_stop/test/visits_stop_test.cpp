#include "interaction/own_stop/core/visits_stop.hpp"

#include <gtest/gtest.h>

namespace usher::own_stop {
namespace {

using std::chrono::milliseconds;

TEST(VisitsStop, EndsOnceWithTheVisit) {
  VisitsStop stop;
  EXPECT_FALSE(stop.ends(false, false)) << "there was none";
  EXPECT_FALSE(stop.ends(true, false));
  EXPECT_FALSE(stop.ends(true, true));
  EXPECT_TRUE(stop.ends(false, false));
  EXPECT_FALSE(stop.ends(false, false));
}

TEST(VisitsStop, OutlastsADialogueThatForgetsItsVisitOnTheWay) {
  VisitsStop stop;
  EXPECT_FALSE(stop.ends(false, true)) << "somebody else's journey";
  EXPECT_FALSE(stop.ends(false, false)) << "is no visit";
  EXPECT_FALSE(stop.ends(true, true));
  EXPECT_FALSE(stop.ends(false, true)) << "the dialogue was restarted";
  EXPECT_TRUE(stop.ends(false, false)) << "the journey has ended";
}

TEST(VisitsStop, AnAnswerThatCrossesAStopWasGivenBeforeIt) {
  VisitsStop stop;
  EXPECT_FALSE(stop.late({})) << "nobody has stopped";
  stop.stop(milliseconds(5000));
  EXPECT_TRUE(stop.late(milliseconds(6499)));
  EXPECT_FALSE(stop.late(milliseconds(6500)));
}

}  // namespace
}  // namespace usher::own_stop
