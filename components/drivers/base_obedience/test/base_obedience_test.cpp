#include "drivers/base_obedience/core/base_obedience.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "foundation/random/random.hpp"

namespace usher::drive {
namespace {

using std::chrono::milliseconds;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr WriterId writer(std::uint8_t number) { return {number, 1, 2, 3}; }
constexpr WriterId kMovement = writer(1);
constexpr WriterId kReplacement = writer(2);
constexpr WriterId kRogue = writer(66);
constexpr WriterId kSupervisor = writer(7);
constexpr WriterId kOtherSupervisor = writer(8);

TEST(BaseObedience, OnlyWhoGrantsMayAskTheBase) {
  WriterId request = kSupervisor;
  request.back() = 9;  // another writer of the same participant
  BaseObedience base;
  EXPECT_FALSE(base.of_grantor(request, milliseconds(0)));
  base.grant({kNobody, 1, kSupervisor}, milliseconds(0));
  EXPECT_TRUE(base.of_grantor(request, milliseconds(119)));
  EXPECT_FALSE(base.of_grantor(kRogue, milliseconds(119)));
  base.grant({kRogue, 9, kRogue}, milliseconds(119));
  EXPECT_FALSE(base.of_grantor(kRogue, milliseconds(119))) << "a second grantor";
  EXPECT_FALSE(base.of_grantor(request, milliseconds(120))) << "silent";
}

struct GrantAt {
  int ms;
  WriterId to;
  std::uint64_t epoch;
  WriterId grantor = kSupervisor;
};
struct CommandAt {
  int ms;
  WriterId from;
  std::uint64_t epoch;
  std::uint64_t sequence;
  double v;
  double w;
  Reason verdict;
  double driven;  ///< the v that the base drives afterwards
};
struct LookAt {
  int ms;
  Reason reason;
  double driven;
};
using Step = std::variant<GrantAt, CommandAt, LookAt>;

struct Case {
  const char* name;
  std::vector<Step> steps;
};

using enum Reason;

const std::vector<Case>& cases() {
  static const std::vector<Case> kCases{
      {"stands before anything is heard", {LookAt{0, kNoGrant, 0.0}}},
      {"stands on a command without a grant",
       {CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kNoGrant, 0.0}, LookAt{1, kNoGrant, 0.0}}},
      {"stands on a grant without a command",
       {GrantAt{0, kMovement, 1}, LookAt{1, kNoCommand, 0.0}}},
      {"drives the granted writer's command",
       {GrantAt{0, kMovement, 1}, CommandAt{1, kMovement, 1, 1, 0.5, 0.2, kObeyed, 0.5},
        LookAt{50, kObeyed, 0.5}}},
      {"a command of before the grant is not driven later",
       {CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kNoGrant, 0.0}, GrantAt{1, kMovement, 1},
        LookAt{2, kNoCommand, 0.0}}},
      {"an epoch that leaps grants nothing, and bars no later one",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{130, kRogue, std::numeric_limits<std::uint64_t>::max(), kOtherSupervisor},
        LookAt{131, kGrantExpired, 0.0}, GrantAt{140, kMovement, 2},
        CommandAt{141, kMovement, 2, 2, 0.5, 0.0, kObeyed, 0.5}}},
      {"command expires after 120 ms of silence",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{100, kMovement, 1}, LookAt{119, kObeyed, 0.5}, LookAt{120, kCommandExpired, 0.0},
        CommandAt{130, kMovement, 1, 2, 0.4, 0.0, kObeyed, 0.4}}},
      {"grant expires after 120 ms of silence",
       {GrantAt{0, kMovement, 1}, CommandAt{100, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        LookAt{119, kObeyed, 0.5}, LookAt{120, kGrantExpired, 0.0},
        CommandAt{121, kMovement, 1, 2, 0.5, 0.0, kGrantExpired, 0.0}}},
      {"a renewal after the expiry revives the grant but no old command",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{130, kMovement, 1, 2, 0.5, 0.0, kGrantExpired, 0.0}, GrantAt{140, kMovement, 1},
        LookAt{140, kNoCommand, 0.0}, CommandAt{141, kMovement, 1, 3, 0.3, 0.0, kObeyed, 0.3}}},
      {"renewals keep it driving",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{100, kMovement, 1}, CommandAt{100, kMovement, 1, 2, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{200, kMovement, 1}, LookAt{210, kObeyed, 0.5}}},
      {"a foreign command changes nothing",
       {GrantAt{0, kMovement, 1}, CommandAt{1, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{2, kRogue, 1, 9, 1.4, 0.0, kForeignWriter, 0.5},
        CommandAt{3, kRogue, 1, 10, kNan, 0.0, kForeignWriter, 0.5}, LookAt{4, kObeyed, 0.5},
        CommandAt{5, kMovement, 1, 2, 0.6, 0.0, kObeyed, 0.6}}},
      {"a foreign command does not refresh",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{100, kMovement, 1}, CommandAt{119, kRogue, 1, 2, 0.5, 0.0, kForeignWriter, 0.5},
        LookAt{120, kCommandExpired, 0.0}}},
      {"an older or newer epoch stops",
       {GrantAt{0, kMovement, 5}, CommandAt{0, kMovement, 5, 1, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{1, kMovement, 4, 2, 0.5, 0.0, kWrongEpoch, 0.0}, LookAt{2, kNoCommand, 0.0},
        CommandAt{3, kMovement, 6, 3, 0.5, 0.0, kWrongEpoch, 0.0},
        CommandAt{4, kMovement, 5, 4, 0.5, 0.0, kObeyed, 0.5}}},
      {"a repeated sequence stops, so does a smaller one",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 7, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{1, kMovement, 1, 7, 0.5, 0.0, kSequenceNotGrowing, 0.0},
        CommandAt{2, kMovement, 1, 3, 0.5, 0.0, kSequenceNotGrowing, 0.0},
        CommandAt{3, kMovement, 1, 9, 0.5, 0.0, kObeyed, 0.5}}},
      {"the first sequence may be zero",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 0, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{1, kMovement, 1, 0, 0.5, 0.0, kSequenceNotGrowing, 0.0}}},
      {"NaN stops",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{1, kMovement, 1, 2, kNan, 0.0, kNotFinite, 0.0}, LookAt{2, kNoCommand, 0.0},
        CommandAt{3, kMovement, 1, 3, 0.0, kNan, kNotFinite, 0.0},
        CommandAt{4, kMovement, 1, 4, 0.5, 0.0, kObeyed, 0.5}}},
      {"infinity stops",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        CommandAt{1, kMovement, 1, 2, 0.5, -kInfinity, kNotFinite, 0.0}}},
      {"beyond the absolute limits stops, at them drives",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 1.5, -1.5, kObeyed, 1.5},
        CommandAt{1, kMovement, 1, 2, -1.51, 0.0, kBeyondLimits, 0.0},
        CommandAt{2, kMovement, 1, 3, -1.5, 0.0, kObeyed, -1.5},
        CommandAt{3, kMovement, 1, 4, 0.0, 1.51, kBeyondLimits, 0.0}}},
      {"the supervisor withdraws at once",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{10, kNobody, 1}, LookAt{10, kNoGrant, 0.0},
        CommandAt{11, kMovement, 1, 2, 0.5, 0.0, kNoGrant, 0.0}}},
      {"a withdrawn epoch cannot be renewed",
       {GrantAt{0, kMovement, 1}, GrantAt{10, kNobody, 1}, GrantAt{20, kMovement, 1},
        CommandAt{21, kMovement, 1, 1, 0.5, 0.0, kNoGrant, 0.0}, GrantAt{30, kMovement, 2},
        CommandAt{31, kMovement, 2, 2, 0.5, 0.0, kObeyed, 0.5}}},
      {"an older grant is ignored",
       {GrantAt{0, kMovement, 5}, GrantAt{10, kReplacement, 4}, GrantAt{11, kNobody, 3},
        CommandAt{12, kReplacement, 4, 1, 0.5, 0.0, kForeignWriter, 0.0},
        CommandAt{13, kMovement, 5, 1, 0.5, 0.0, kObeyed, 0.5}}},
      {"an older grant does not renew",
       {GrantAt{0, kMovement, 5}, GrantAt{100, kMovement, 4}, LookAt{120, kGrantExpired, 0.0}}},
      {"one epoch has one holder",
       {GrantAt{0, kMovement, 5}, CommandAt{0, kMovement, 5, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{10, kReplacement, 5}, LookAt{10, kNoGrant, 0.0},
        CommandAt{11, kReplacement, 5, 1, 0.5, 0.0, kNoGrant, 0.0}, GrantAt{12, kMovement, 5},
        LookAt{12, kNoGrant, 0.0}, GrantAt{20, kReplacement, 6},
        CommandAt{21, kReplacement, 6, 2, 0.5, 0.0, kObeyed, 0.5}}},
      {"a replacement counts from anew and the old writer is foreign",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 900, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{10, kReplacement, 2}, LookAt{10, kNoCommand, 0.0},
        CommandAt{11, kReplacement, 2, 1, 0.3, 0.0, kObeyed, 0.3},
        CommandAt{12, kMovement, 2, 901, 0.5, 0.0, kForeignWriter, 0.3}}},
      {"a new epoch of the same writer voids the command and keeps the sequence",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 5, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{10, kMovement, 2}, LookAt{10, kNoCommand, 0.0},
        CommandAt{11, kMovement, 2, 5, 0.5, 0.0, kSequenceNotGrowing, 0.0},
        CommandAt{12, kMovement, 2, 6, 0.5, 0.0, kObeyed, 0.5}}},
      {"two grantors stop until one is silent",
       {GrantAt{0, kMovement, 1}, CommandAt{0, kMovement, 1, 1, 0.5, 0.0, kObeyed, 0.5},
        GrantAt{10, kRogue, 99, kOtherSupervisor}, LookAt{10, kTwoGrantors, 0.0},
        CommandAt{11, kRogue, 99, 1, 1.0, 0.0, kTwoGrantors, 0.0}, GrantAt{20, kMovement, 1},
        CommandAt{21, kMovement, 1, 2, 0.5, 0.0, kTwoGrantors, 0.0}, GrantAt{125, kMovement, 1},
        LookAt{131, kNoCommand, 0.0}, CommandAt{132, kMovement, 1, 3, 0.5, 0.0, kObeyed, 0.5}}},
      {"a restarted supervisor is heard once the old one is silent",
       {GrantAt{0, kMovement, 1}, GrantAt{120, kMovement, 2, kOtherSupervisor},
        CommandAt{121, kMovement, 2, 1, 0.5, 0.0, kObeyed, 0.5}}},
      {"nobody is not a holder",
       {GrantAt{0, kNobody, 3}, CommandAt{1, kNobody, 3, 1, 0.5, 0.0, kNoGrant, 0.0}}},
  };
  return kCases;
}

Time at(int ms) { return milliseconds(1000 + ms); }

TEST(BaseObedience, FollowsTheTable) {
  for (const Case& test : cases()) {
    BaseObedience base;
    int number = 0;
    for (const Step& step : test.steps) {
      SCOPED_TRACE(std::string(test.name) + ", step " + std::to_string(number++));
      if (const auto* grant = std::get_if<GrantAt>(&step)) {
        base.grant({grant->to, grant->epoch, grant->grantor}, at(grant->ms));
      } else if (const auto* command = std::get_if<CommandAt>(&step)) {
        const Decision decision = base.permitted(
            {command->from, command->epoch, command->sequence, {command->v, command->w}},
            at(command->ms));
        EXPECT_EQ(text(decision.reason), text(command->verdict));
        EXPECT_EQ(decision.twist.v, command->driven);
      } else {
        const auto& look = std::get<LookAt>(step);
        const Decision decision = base.permitted(at(look.ms));
        EXPECT_EQ(text(decision.reason), text(look.reason));
        EXPECT_EQ(decision.twist.v, look.driven);
      }
    }
  }
}

TEST(BaseObedience, WhatComesLateIsAsOldAsItIs) {
  using std::chrono::milliseconds;
  const WriterId movement{1}, supervisor{2};
  BaseObedience obedience;
  obedience.grant({movement, 1, supervisor, milliseconds(100)}, milliseconds(0));
  EXPECT_EQ(obedience.permitted({movement, 1, 1, {0.5, 0.0}}, milliseconds(10)).reason,
            Reason::kObeyed);
  EXPECT_EQ(obedience.permitted(milliseconds(20)).reason, Reason::kGrantExpired);
  obedience.grant({movement, 1, supervisor}, milliseconds(30));
  const Decision late =
      obedience.permitted({movement, 1, 2, {0.5, 0.0}, milliseconds(120)}, milliseconds(40));
  EXPECT_EQ(late.twist, (geometry::Twist2{}));
  EXPECT_EQ(obedience.permitted({movement, 1, 3, {0.5, 0.0}, milliseconds(100)}, milliseconds(50))
                .twist.v,
            0.5);
  EXPECT_EQ(obedience.permitted(milliseconds(71)).reason, Reason::kCommandExpired);
}

TEST(BaseObedience, AGrantMayLiveShorterThanTheLimitNeverLonger) {
  using std::chrono::milliseconds;
  const WriterId movement{1}, supervisor{2};
  for (const auto& [wished, lives] : {std::pair{40, 40}, {500, 120}}) {
    BaseObedience obedience;
    obedience.grant({movement, 1, supervisor, {}, milliseconds(wished)}, milliseconds(0));
    obedience.permitted({movement, 1, 1, {0.5, 0.0}}, milliseconds(0));
    EXPECT_EQ(obedience.permitted(milliseconds(lives - 1)).reason, Reason::kObeyed) << wished;
    EXPECT_EQ(obedience.permitted(milliseconds(lives)).reason, Reason::kGrantExpired) << wished;
  }
}

TEST(BaseObedience, TheTableHasACaseForEveryReason) {
  std::set<Reason> seen;
  for (const Case& test : cases()) {
    for (const Step& step : test.steps) {
      if (const auto* command = std::get_if<CommandAt>(&step)) seen.insert(command->verdict);
      if (const auto* look = std::get_if<LookAt>(&step)) seen.insert(look->reason);
    }
  }
  EXPECT_EQ(seen.size(), kReasonCount);
}

TEST(BaseObedience, EveryReasonHasAnOwnText) {
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    EXPECT_NE(text(static_cast<Reason>(i)), "unknown reason");
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_NE(text(static_cast<Reason>(i)), text(static_cast<Reason>(j)));
    }
  }
}

TEST(BaseObedience, CountsItsVerdicts) {
  BaseObedience base;
  base.grant({kMovement, 1, kSupervisor}, at(0));
  for (std::uint64_t i = 1; i <= 3; ++i) base.permitted({kMovement, 1, i, {0.1, 0.0}}, at(1));
  base.permitted({kRogue, 1, 9, {0.1, 0.0}}, at(1));
  EXPECT_EQ(base.count(kObeyed), 3U);
  EXPECT_EQ(base.count(kForeignWriter), 1U);
  EXPECT_EQ(base.highest_epoch(), 1U);
}

// The law behind the table: what is driven is the newest obeyed command of the holder of the newest
// grant, both younger than the expiry.
TEST(BaseObedience, NeverDrivesWithoutALiveGrantAndAFreshCommand) {
  Random random(1);
  const std::array<WriterId, 3> writers{kMovement, kReplacement, kRogue};
  for (int run = 0; run < 300; ++run) {
    BaseObedience base;
    int ms = 0;
    std::uint64_t epoch = 0;
    WriterId holder = kNobody;
    int granted = -1000;
    int obeyed = -1000;
    double obeyed_v = 0.0;
    for (int i = 0; i < 300; ++i) {
      ms += static_cast<int>(random.below(random.below(20) == 0 ? 200 : 30));
      if (random.below(3) == 0) {
        const bool renew = random.below(4) != 0;
        if (!renew || holder == kNobody) {
          ++epoch;
          holder = writers[random.below(writers.size())];
          obeyed = -1000;
        }
        granted = ms;
        base.grant({holder, epoch, kSupervisor}, at(ms));
      } else {
        const Command command{writers[random.below(writers.size())],
                              epoch - random.below(2),
                              random.below(1000),
                              {random.below(20) == 0 ? kNan : random.uniform(-1.6, 1.6), 0.0}};
        const Decision decision = base.permitted(command, at(ms));
        if (decision.reason == kObeyed) {
          ASSERT_EQ(command.writer, holder);
          ASSERT_EQ(command.epoch, epoch);
          ASSERT_LE(std::abs(command.twist.v), 1.5);
          obeyed = ms;
          obeyed_v = command.twist.v;
        } else if (command.writer == holder) {
          obeyed = -1000;
        }
      }
      const geometry::Twist2 driven = base.permitted(at(ms)).twist;
      const bool may = holder != kNobody && ms - granted < 120 && ms - obeyed < 120;
      ASSERT_EQ(driven.v, may ? obeyed_v : 0.0) << "run " << run << " event " << i;
    }
  }
}

}  // namespace
}  // namespace usher::drive
