#include "runtime/dds/signed_presence.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "runtime/dds/lease_check.hpp"

namespace usher::runtime {
namespace {

using std::chrono::milliseconds;
constexpr SignedPresence::Prefix kOne{1};
constexpr SignedPresence::Prefix kTwo{2};

/// Announcements every 200 ms in [from, to); whether all were heard.
bool hears_all(SignedPresence& presence, milliseconds from, milliseconds to,
               const SignedPresence::Prefix& prefix = kOne) {
  bool all = true;
  for (auto now = from; now < to; now += milliseconds(200))
    all = presence.hears(prefix, now) && all;
  return all;
}

constexpr milliseconds kStep(100);
constexpr milliseconds kMeeting(SignedPresence::kMeeting.count() / 1'000'000);
constexpr milliseconds kAsking(SignedPresence::kAsking.count() / 1'000'000);
constexpr milliseconds kSilence(SignedPresence::kSilence.count() / 1'000'000);
constexpr milliseconds kForgetting(SignedPresence::kForgetting.count() / 1'000'000);

TEST(SignedPresence, HearsForeverWhoIsMetNowAndThen) {
  SignedPresence presence;
  for (auto now = milliseconds(0); now < 50 * kSilence; now += kSilence - kStep) {
    ASSERT_TRUE(hears_all(presence, now, now + kSilence - kStep));
    presence.met(kOne, now + kSilence - kStep);
  }
}

TEST(SignedPresence, IgnoresWhoIsNeverMetUntilItIsForgottenAndThenHearsItAnew) {
  SignedPresence presence;
  presence.call_us(kTwo);
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kMeeting + kStep));
  const auto ignored = kMeeting + kStep;
  EXPECT_FALSE(presence.hears(kOne, ignored));
  presence.met(kOne, ignored);  // was under way; Fast DDS forgets it all the same
  EXPECT_FALSE(presence.hears(kOne, ignored + kStep));
  presence.gone(kOne);
  const auto anew = ignored + 2 * kStep;
  EXPECT_TRUE(hears_all(presence, anew, anew + kMeeting));
  EXPECT_FALSE(hears_all(presence, anew + kMeeting, anew + kMeeting + 5 * kStep));
}

TEST(SignedPresence, HearsAnewWhomNobodyKnewToForget) {
  SignedPresence presence;
  presence.call_us(kTwo);
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kMeeting + kStep));
  const auto ignored = kMeeting + kStep;
  for (auto now = ignored; now < ignored + kForgetting; now += kStep)
    EXPECT_FALSE(presence.hears(kOne, now)) << now.count();
  const auto anew = ignored + kForgetting;
  EXPECT_TRUE(hears_all(presence, anew, anew + kMeeting));
}

TEST(SignedPresence, WhoAsksIsPatientUntilTheOtherHasBegunAnewTwice) {
  SignedPresence presence;
  presence.call_us(kOne);
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kAsking, kTwo));
  EXPECT_FALSE(presence.hears(kTwo, kAsking + kStep));
  EXPECT_GT(kAsking, 2 * (kMeeting + kForgetting));
  EXPECT_NE(kAsking.count() % (kMeeting + kForgetting).count(), 0) << "out of step";
}

TEST(SignedPresence, BeginsAnewWithWhomIsForgotten) {
  SignedPresence presence;
  presence.call_us(kTwo);
  EXPECT_TRUE(presence.hears(kOne, milliseconds(0)));
  presence.met(kOne, milliseconds(0));
  presence.gone(kOne);
  EXPECT_TRUE(hears_all(presence, 2 * kSilence, 2 * kSilence + kMeeting)) << "after a cut";
}

TEST(SignedPresence, IgnoresWhoIsNoLongerMet) {
  SignedPresence presence;
  EXPECT_TRUE(presence.hears(kOne, milliseconds(0)));
  presence.met(kOne, milliseconds(0));
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kSilence + kStep));
  EXPECT_FALSE(presence.hears(kOne, kSilence + kStep)) << "it begins anew";
  const auto anew = kSilence + 2 * kStep + kForgetting;
  EXPECT_TRUE(presence.hears(kOne, anew));
  presence.met(kOne, anew + kStep);
  EXPECT_TRUE(presence.hears(kOne, anew + kSilence));
}

TEST(SignedPresence, IsMeetingWhomItHearsAndHasNotMetYet) {
  SignedPresence presence;
  presence.call_us(kTwo);
  EXPECT_FALSE(presence.is_meeting(kOne));
  EXPECT_TRUE(presence.hears(kOne, milliseconds(0)));
  EXPECT_TRUE(presence.is_meeting(kOne));
  presence.met(kOne, kStep);
  EXPECT_FALSE(presence.is_meeting(kOne));
  presence.gone(kOne);
  EXPECT_FALSE(presence.is_meeting(kOne));
  EXPECT_TRUE(presence.hears(kOne, 2 * kStep));
  EXPECT_TRUE(presence.is_meeting(kOne));
  EXPECT_FALSE(presence.hears(kOne, 3 * kStep + kMeeting));
  EXPECT_FALSE(presence.is_meeting(kOne)) << "it is ignored";
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
    EXPECT_TRUE(presence->hears(kOne, milliseconds(0)));
    EXPECT_EQ(allowed(), SignedPresence::kShyness);
    EXPECT_EQ(LeaseCheck::allowed_silence(kUs, kOne, 2 * SignedPresence::kShyness),
              2 * SignedPresence::kShyness);
    EXPECT_EQ(LeaseCheck::allowed_silence(kUs, kTwo, kLease), kLease);
    presence->met(kOne, kStep);
    EXPECT_EQ(allowed(), kLease);
    presence->gone(kOne);
    EXPECT_TRUE(presence->hears(kOne, milliseconds(0)));
    EXPECT_EQ(allowed(), SignedPresence::kShyness);
  }
  EXPECT_EQ(allowed(), kLease) << "our participant has gone";
}

TEST(SignedPresence, IsNotMetBeforeItIsHeard) {
  SignedPresence presence;
  presence.met(kOne, milliseconds(0));
  EXPECT_TRUE(hears_all(presence, kMeeting, 2 * kMeeting));
}

TEST(SignedPresence, TellsParticipantsApart) {
  SignedPresence presence;
  presence.call_us({0xff});
  EXPECT_TRUE(hears_all(presence, milliseconds(0), kMeeting + kStep));
  EXPECT_FALSE(presence.hears(kOne, kMeeting + kStep));
  EXPECT_TRUE(presence.hears(kTwo, kMeeting + kStep));
}

TEST(SignedPresence, RemembersNoMoreThanItMust) {
  SignedPresence presence;
  for (int i = 0; i < 100'000; ++i) {
    SignedPresence::Prefix prefix{};
    prefix[0] = static_cast<std::uint8_t>(i);
    prefix[1] = static_cast<std::uint8_t>(i >> 8);
    prefix[2] = static_cast<std::uint8_t>(i >> 16);
    EXPECT_TRUE(presence.hears(prefix, milliseconds(i % 1000)));
  }
}

}  // namespace
}  // namespace usher::runtime
