#include "simulation/visitor/core/hearing.hpp"

#include <gtest/gtest.h>

namespace usher::visitor {
namespace {

/// Says "yes" on screen 7 until something reaches the robot; nothing: it did not within a
/// minute.
std::optional<Hearing::Answer> say(Hearing& hearing, double& now) {
  hearing.see(7, {"yes", "no", "guide_me"}, true);
  hearing.want(7, "yes", now);
  for (int steps = 0; steps < 300; ++steps, now += 0.2) {
    hearing.want(7, "yes", now);
    if (auto answer = hearing.step(now)) return answer;
  }
  return std::nullopt;
}

TEST(Hearing, UnderstandsAtOnce) {
  Hearing hearing({1.0, 0.0, 0.0}, Random(1));
  double now = 3.0;
  EXPECT_EQ(say(hearing, now)->option, "yes");
  EXPECT_EQ(now, 3.0);
  EXPECT_EQ(hearing.said(), 1U);
}

TEST(Hearing, AsksBackWhichTakesTimeAndAnotherWord) {
  Hearing hearing({0.0, 1.0, 0.0, 1.0}, Random(1));
  double now = 3.0;
  EXPECT_EQ(say(hearing, now)->option, "yes");
  EXPECT_NEAR(now, 3.0 + Hearing::kQuestion, 0.3);
  EXPECT_EQ(hearing.said(), 2U);
  EXPECT_EQ(hearing.asked_back(), 1U);
}

TEST(Hearing, AQuestionBackMayFailToo) {
  Hearing hearing({0.0, 1.0, 0.0, 0.0}, Random(1));
  double now = 3.0;
  EXPECT_EQ(say(hearing, now)->means, Means::kTouch);
  EXPECT_EQ(hearing.asked_back(), 4U);
}

TEST(Hearing, TakesAWordForAnotherOfTheScreen) {
  Hearing hearing({0.0, 0.0, 1.0}, Random(1));
  double now = 3.0;
  const auto answer = say(hearing, now);
  EXPECT_TRUE(answer->option == "no" || answer->option == "guide_me") << answer->option;
  EXPECT_EQ(hearing.mistaken(), 1U);
  hearing.see(8, {"yes", "no"}, true);
  EXPECT_FALSE(hearing.step(now + 10.0)) << "that screen is gone, and the wish with it";
}

TEST(Hearing, WhatIsNeverHeardIsTouched) {
  Hearing hearing({0.0, 0.0, 0.0}, Random(1));
  double now = 3.0;
  const auto answer = say(hearing, now);
  EXPECT_EQ(answer->option, "yes");
  EXPECT_EQ(answer->means, Means::kTouch);
  EXPECT_EQ(hearing.said(), 4U);
  EXPECT_EQ(hearing.fell_back(), 1U);
  EXPECT_NEAR(now, 3.0 + 4.0 * Delivery::kSayAgain, 1.0);
}

TEST(Hearing, HearsOnlyWhatMayBeSaidUnaskedWhereNobodyListens) {
  Hearing hearing({1.0, 0.0, 0.0}, Random(1));
  hearing.see(7, {"language:de", "stop"}, false);
  hearing.want(7, "language:de", 0.0);
  EXPECT_FALSE(hearing.step(0.0));
  hearing.want(7, "stop", 1.0);
  EXPECT_EQ(hearing.step(1.0)->option, "stop");
}

TEST(Hearing, KeepsItsRates) {
  int first = 0, at_once = 0, asked = 0, mistaken = 0;
  Random random(5);
  for (int i = 0; i < 4000; ++i) {
    Hearing hearing({}, Random(random.below(1000000)));
    double now = 0.0;
    const auto answer = say(hearing, now);
    ASSERT_TRUE(answer);
    asked += hearing.asked_back() > 0 ? 1 : 0;
    mistaken += hearing.mistaken() > 0 ? 1 : 0;
    const bool right = answer->option == "yes" && answer->means == Means::kVoice;
    first += right && now < Hearing::kQuestion + 0.5 ? 1 : 0;
    at_once += hearing.said() == 1 && answer->option == "yes" ? 1 : 0;
  }
  EXPECT_NEAR(at_once / 4000.0, 0.48, 0.03);
  EXPECT_NEAR(first / 4000.0, 0.86, 0.02) << "speech/README.md, ten commands in noise";
  EXPECT_GT(asked, 0.41 * 4000.0);
  EXPECT_NEAR(mistaken / 4000.0, 0.03, 0.01);
}

}  // namespace
}  // namespace usher::visitor
