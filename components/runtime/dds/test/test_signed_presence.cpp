#include "runtime/dds/signed_presence.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>

#include "runtime/dds/lease_check.hpp"

namespace usher::runtime {
namespace {

using std::chrono::milliseconds;
constexpr SignedPresence::Prefix kOne{1};
constexpr SignedPresence::Prefix kTwo{2};
constexpr SignedPresence::Prefix kFour{4};

/// A message every 200 ms in [from, to]; whether all were heard.
bool hears_all(SignedPresence& presence, milliseconds from, milliseconds to, bool is_signed = false,
               const SignedPresence::Prefix& prefix = kOne) {
  bool all = true;
  for (auto now = from; now <= to; now += milliseconds(200))
    all = presence.hears(prefix, is_signed, now) && all;
  return all;
}

milliseconds whole(Duration duration) { return std::chrono::duration_cast<milliseconds>(duration); }

const milliseconds kStep(100);
const milliseconds kAnswering = whole(SignedPresence::kAnswering);
const milliseconds kAsking = whole(SignedPresence::kAsking);
const milliseconds kMeeting = whole(SignedPresence::kMeeting);
const milliseconds kMute = whole(SignedPresence::kMute);
const milliseconds kSilence = whole(SignedPresence::kSilence);
const milliseconds kForgetting = whole(SignedPresence::kForgetting);

/// Who answers kOne and asks kFour.
class PresenceTest : public testing::Test {
 public:
  PresenceTest() { presence.call_us(kTwo); }
  SignedPresence presence;
};

TEST_F(PresenceTest, HearsForeverWhoIsMetNowAndThen) {
  for (auto now = milliseconds(0); now < 50 * kSilence; now += kSilence - kStep) {
    ASSERT_TRUE(hears_all(presence, now, now + kSilence - kStep));
    presence.met(kOne, now + kSilence - kStep);
  }
}

TEST_F(PresenceTest, IgnoresWhoNeverSignsUntilItIsForgottenAndThenHearsItAnew) {
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kAnswering));
  const auto ignored = kAnswering + kStep;
  EXPECT_FALSE(presence.hears(kOne, false, ignored));
  presence.met(kOne, ignored);  // was under way; Fast DDS forgets it all the same
  EXPECT_FALSE(presence.hears(kOne, true, ignored + kStep));
  presence.gone(kOne);
  const auto anew = ignored + 2 * kStep;
  EXPECT_TRUE(hears_all(presence, anew, anew + kAnswering));
  EXPECT_FALSE(presence.hears(kOne, false, anew + kAnswering + kStep));
}

TEST_F(PresenceTest, HearsAnewWhomNobodyKnewToForget) {
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kAnswering));
  const auto ignored = kAnswering + kStep;
  for (auto now = ignored; now < ignored + kForgetting; now += kStep)
    EXPECT_FALSE(presence.hears(kOne, false, now)) << now.count();
  const auto anew = ignored + kForgetting;
  EXPECT_TRUE(hears_all(presence, anew, anew + kAnswering));
}

TEST_F(PresenceTest, IsPatientWithWhomItAsksUntilThatOneHasBegunAnewTwice) {
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kAsking, false, kFour));
  EXPECT_FALSE(presence.hears(kFour, false, kAsking + kStep));
  EXPECT_GT(kAsking, 2 * (kAnswering + kForgetting));
}

TEST_F(PresenceTest, IgnoresWhoSignsAndIsNotMet) {
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kMeeting, true)) << "a slow machine";
  EXPECT_FALSE(presence.hears(kOne, true, kMeeting + kStep));
}

TEST_F(PresenceTest, IgnoresWhoSignsNoLonger) {
  EXPECT_TRUE(presence.hears(kFour, true, milliseconds(0)));
  EXPECT_TRUE(hears_all(presence, kStep, kMute, false, kFour));
  EXPECT_FALSE(presence.hears(kFour, false, kMute + kStep)) << "it has begun anew";
}

TEST_F(PresenceTest, IgnoresWhoIsNoLongerMet) {
  EXPECT_TRUE(presence.hears(kOne, false, milliseconds(0)));
  presence.met(kOne, milliseconds(0));
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kSilence, true));
  EXPECT_FALSE(presence.hears(kOne, true, kSilence + kStep)) << "it begins anew";
  const auto anew = kSilence + 2 * kStep + kForgetting;
  EXPECT_TRUE(presence.hears(kOne, false, anew));
  presence.met(kOne, anew + kStep);
  EXPECT_TRUE(presence.hears(kOne, false, anew + kSilence));
}

TEST_F(PresenceTest, BeginsAnewWithWhomIsForgotten) {
  EXPECT_TRUE(presence.hears(kOne, false, milliseconds(0)));
  presence.met(kOne, milliseconds(0));
  presence.gone(kOne);
  EXPECT_TRUE(hears_all(presence, 2 * kSilence, 2 * kSilence + kAnswering)) << "after a cut";
}

TEST_F(PresenceTest, IsMeetingWhomItHearsAndHasNotMetYet) {
  EXPECT_FALSE(presence.is_meeting(kOne));
  EXPECT_TRUE(presence.hears(kOne, false, milliseconds(0)));
  EXPECT_TRUE(presence.is_meeting(kOne));
  EXPECT_TRUE(presence.hears(kOne, true, milliseconds(0)));
  EXPECT_TRUE(presence.is_meeting(kOne));
  presence.met(kOne, kStep);
  EXPECT_FALSE(presence.is_meeting(kOne));
  presence.gone(kOne);
  EXPECT_FALSE(presence.is_meeting(kOne));
  EXPECT_TRUE(presence.hears(kOne, false, 2 * kStep));
  EXPECT_TRUE(presence.is_meeting(kOne));
  EXPECT_FALSE(presence.hears(kOne, false, 3 * kStep + kAnswering));
  EXPECT_FALSE(presence.is_meeting(kOne)) << "it is ignored";
}

TEST_F(PresenceTest, IsNotMetBeforeItIsHeard) {
  presence.met(kOne, milliseconds(0));
  EXPECT_TRUE(hears_all(presence, kSilence, kSilence + kAnswering));
}

TEST_F(PresenceTest, TellsParticipantsApart) {
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kAnswering));
  EXPECT_FALSE(presence.hears(kOne, false, kAnswering + kStep));
  EXPECT_TRUE(presence.hears(kFour, false, kAnswering + kStep));
}

TEST_F(PresenceTest, RemembersNoMoreThanItMust) {
  for (int i = 0; i < 100'000; ++i) {
    SignedPresence::Prefix prefix{};
    prefix[0] = static_cast<std::uint8_t>(i);
    prefix[1] = static_cast<std::uint8_t>(i >> 8);
    prefix[2] = static_cast<std::uint8_t>(i >> 16);
    EXPECT_TRUE(presence.hears(prefix, i % 2 == 0, milliseconds(i % 1000)));
  }
}

TEST(LeaseCheck, GivesTimeToWhomWeMeet) {
  constexpr milliseconds kLease(800);
  constexpr SignedPresence::Prefix kUs{7};
  const auto presence = std::make_shared<SignedPresence>();
  const auto allowed = [&] { return LeaseCheck::allowed_silence(kUs, kOne, kLease); };
  EXPECT_EQ(allowed(), kLease) << "without keys";
  {
    const LeaseCheck check(kUs, presence);
    EXPECT_EQ(allowed(), kLease);
    EXPECT_TRUE(presence->hears(kOne, false, milliseconds(0)));
    EXPECT_EQ(allowed(), SignedPresence::kShyness);
    EXPECT_EQ(LeaseCheck::allowed_silence(kUs, kOne, 2 * SignedPresence::kShyness),
              2 * SignedPresence::kShyness);
    EXPECT_EQ(LeaseCheck::allowed_silence(kUs, kFour, kLease), kLease);
    presence->met(kOne, kStep);
    EXPECT_EQ(allowed(), kLease);
    presence->gone(kOne);
    EXPECT_TRUE(presence->hears(kOne, false, milliseconds(0)));
    EXPECT_EQ(allowed(), SignedPresence::kShyness);
  }
  EXPECT_EQ(allowed(), kLease) << "our participant has gone";
}

}  // namespace
}  // namespace usher::runtime
