#include "simulation/visitor/core/delivery.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/visitor/core/mouth.hpp"

namespace usher::visitor {
namespace {

const Ear kSilent;
const Ear kListens{.listens = true};
Ear asks(const std::string& label) {
  return {.listens = true, .asks = true, .hint = "Did you say \"" + label + "\"?"};
}
Delivery::Wanted library(Means means) { return {5, "library", "Library", means, false}; }
const Deed kSaid{Means::kVoice, "Library"};
const Deed kTouched{Means::kTouch, "library"};

TEST(Delivery, TouchesUntilAnotherScreenIsThere) {
  Delivery delivery;
  delivery.want(library(Means::kTouch), 10.0);
  EXPECT_EQ(delivery.step(kSilent, 10.0), kTouched);
  EXPECT_EQ(delivery.step(kSilent, 11.0), std::nullopt);
  EXPECT_EQ(delivery.step(kSilent, 11.6), kTouched);
  delivery.see(5, {"library", "lounge"});
  EXPECT_EQ(delivery.step(kSilent, 13.2), kTouched) << "the same screen was repeated";
  delivery.see(6, {"library"});
  EXPECT_EQ(delivery.step(kSilent, 20.0), std::nullopt);

  delivery.want(library(Means::kTouch), 30.0);
  EXPECT_EQ(delivery.step(kSilent, 30.0), kTouched);
  delivery.want(library(Means::kTouch), 30.2);
  EXPECT_EQ(delivery.step(kSilent, 30.2), std::nullopt) << "wanted already";
  delivery.see(5, {"lounge"});
  EXPECT_EQ(delivery.step(kSilent, 40.0), std::nullopt) << "not offered any more";
}

TEST(Delivery, LetsTheRobotFinishItsSentenceUnlessItIsUrgent) {
  Delivery delivery;
  delivery.want(library(Means::kVoice), 10.0);
  EXPECT_EQ(delivery.step({.listens = true, .sounds = true}, 10.0), std::nullopt);
  EXPECT_EQ(delivery.step(kListens, 12.0), kSaid);
  EXPECT_EQ(delivery.step(kListens, 16.0), std::nullopt);
  EXPECT_EQ(delivery.step(kListens, 17.1), kSaid) << "nothing happened";
  delivery.want({6, "stop", "Stop", Means::kVoice, true}, 20.0);
  EXPECT_EQ(delivery.step({.listens = true, .sounds = true}, 20.0), (Deed{Means::kVoice, "Stop"}));
}

TEST(Delivery, AnswersQuestionsBackTruly) {
  Delivery delivery;
  delivery.want(library(Means::kVoice), 10.0);
  EXPECT_EQ(delivery.step(kListens, 10.0), kSaid);
  Ear question = asks("Lounge");
  EXPECT_EQ(delivery.step(question, 12.0), std::nullopt) << "the robot is about to speak";
  question.sounds = true;
  EXPECT_EQ(delivery.step(question, 13.0), std::nullopt);
  question.sounds = false;
  EXPECT_EQ(delivery.step(question, 14.0), (Deed{Means::kVoice, "no"}));
  EXPECT_EQ(delivery.step(question, 15.0), std::nullopt) << "once";
  EXPECT_EQ(delivery.step(asks("Library"), 15.0), std::nullopt);
  EXPECT_EQ(delivery.step(asks("Library"), 15.8), (Deed{Means::kVoice, "yes"}));
  delivery.see(6, {});
  EXPECT_EQ(delivery.step(kListens, 22.0), std::nullopt);
  EXPECT_EQ(delivery.step(asks("Library"), 30.0), std::nullopt);
  EXPECT_EQ(delivery.step(asks("Library"), 31.0), (Deed{Means::kVoice, "no"}))
      << "nothing was said";
}

TEST(Delivery, UsesAHandInTheEnd) {
  Delivery unheard;
  unheard.want(library(Means::kVoice), 0.0);
  int said = 0, fifths = 0;
  for (; fifths < 300; ++fifths) {
    const auto deed = unheard.step(kListens, 0.2 * fifths);
    if (deed == kTouched) break;
    said += deed == kSaid ? 1 : 0;
  }
  EXPECT_EQ(said, Delivery::kMostSaid);
  EXPECT_NEAR(0.2 * fifths, Delivery::kMostSaid * Delivery::kSayAgain, 1.0);
  EXPECT_EQ(unheard.fell_back(), 1U);

  Delivery deaf;
  deaf.want(library(Means::kVoice), 0.0);
  EXPECT_EQ(deaf.step(kSilent, 7.9), std::nullopt);
  EXPECT_EQ(deaf.step(kSilent, 8.1), kTouched);
}

TEST(Mouth, SaysItOnceInARoomThatIsNeverSilent) {
  Mouth mouth;
  Random random(1);
  const auto loudness = [&](std::size_t count) {
    const auto bytes = mouth.next(count, random);
    EXPECT_EQ(bytes.size(), 2 * count);
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto sample = static_cast<std::int16_t>(bytes[2 * i] | (bytes[2 * i + 1] << 8U));
      sum += static_cast<double>(sample) * sample;
    }
    return std::sqrt(sum / static_cast<double>(count));
  };
  EXPECT_NEAR(loudness(1600), 400.0, 40.0);
  mouth.say(std::vector<std::int16_t>(1000, 32767));
  EXPECT_TRUE(mouth.speaks());
  EXPECT_GT(loudness(999), 32000.0) << "clipped, not wrapped round";
  EXPECT_TRUE(mouth.speaks());
  loudness(1);
  EXPECT_FALSE(mouth.speaks());
  EXPECT_NEAR(loudness(1600), 400.0, 40.0);
}

}  // namespace
}  // namespace usher::visitor
