#include "control/supervisor/core/heartbeat_table.hpp"

#include <gtest/gtest.h>

namespace usher::supervisor {
namespace {

using std::chrono::milliseconds;

constexpr std::uint64_t kDigest = 77;

HeartbeatTable table() {
  return {{{"amcl", Criticality::kStop, milliseconds(100)},
           {"people", Criticality::kDegrade, milliseconds(300)},
           {"tablet", Criticality::kNotify, milliseconds(500)}},
          kDigest};
}

Heartbeat beat(const char* name, Reported state = Reported::kOk, std::uint8_t writer = 1,
               std::uint64_t digest = kDigest, const char* reason = "") {
  return {name, {writer}, digest, state, reason};
}

struct Row {  // NOLINT(clang-analyzer-optin.performance.Padding): reads as a sentence
  const char* name;
  Reported state;
  std::uint64_t digest;
  const char* reason;
  int heard_ms;  ///< negative: never
  int judged_ms;
  Health health;
  const char* expected_reason;
};

TEST(HeartbeatTable, JudgesByTheTable) {
  const Row rows[] = {
      {"never heard", Reported::kOk, kDigest, "", -1, 0, Health::kMissing, "never heard"},
      {"well", Reported::kOk, kDigest, "", 0, 99, Health::kOk, ""},
      {"silent", Reported::kOk, kDigest, "", 0, 100, Health::kMissing, "silent"},
      {"starting", Reported::kStarting, kDigest, "no map yet", 0, 10, Health::kMissing,
       "no map yet"},
      {"starting without words", Reported::kStarting, kDigest, "", 0, 10, Health::kMissing,
       "starting"},
      {"degraded", Reported::kDegraded, kDigest, "few beams", 0, 10, Health::kDegraded,
       "few beams"},
      {"failed", Reported::kFault, kDigest, "no map", 0, 10, Health::kFault, "no map"},
      {"unknown state", static_cast<Reported>(99), kDigest, "", 0, 10, Health::kFault, "failed"},
      {"other IDL", Reported::kOk, kDigest + 1, "", 0, 10, Health::kWrongIdl,
       "built from another IDL than the supervisor"},
  };
  for (const Row& row : rows) {
    HeartbeatTable heartbeats = table();
    if (row.heard_ms >= 0) {
      ASSERT_TRUE(heartbeats.hear(beat("amcl", row.state, 1, row.digest, row.reason),
                                  milliseconds(row.heard_ms)));
    }
    heartbeats.judge(milliseconds(row.judged_ms));
    const ComponentHealth* amcl = heartbeats.find("amcl");
    ASSERT_NE(amcl, nullptr);
    EXPECT_EQ(amcl->health, row.health) << row.name;
    EXPECT_EQ(amcl->reason, row.expected_reason) << row.name;
    const bool able = row.health == Health::kOk || row.health == Health::kDegraded;
    EXPECT_EQ(heartbeats.first_lost(Criticality::kStop) == nullptr, able) << row.name;
  }
}

TEST(HeartbeatTable, OnlyCriticalOnesStopAndOnlyTheseTwoSlow) {
  HeartbeatTable heartbeats = table();
  const auto beat_all = [&](int ms) {
    for (const char* name : {"amcl", "people", "tablet"}) {
      heartbeats.hear(beat(name), milliseconds(ms));
    }
  };
  beat_all(0);
  heartbeats.judge(milliseconds(0));
  EXPECT_EQ(heartbeats.first_lost(Criticality::kStop), nullptr);
  EXPECT_FALSE(heartbeats.degraded());

  for (int ms = 50; ms <= 600; ms += 50) {  // the tablet and then the people detector fall silent
    heartbeats.hear(beat("amcl"), milliseconds(ms));
    if (ms < 400) heartbeats.hear(beat("people"), milliseconds(ms));
  }
  heartbeats.judge(milliseconds(600));
  EXPECT_EQ(heartbeats.find("tablet")->health, Health::kMissing);
  EXPECT_EQ(heartbeats.find("people")->health, Health::kOk);
  EXPECT_FALSE(heartbeats.degraded());
  heartbeats.hear(beat("amcl"), milliseconds(680));
  heartbeats.judge(milliseconds(690));
  EXPECT_EQ(heartbeats.find("people")->health, Health::kMissing);
  EXPECT_TRUE(heartbeats.degraded());
  EXPECT_EQ(heartbeats.first_lost(Criticality::kStop), nullptr);
  beat_all(700);
  heartbeats.judge(milliseconds(700));
  EXPECT_FALSE(heartbeats.degraded());
  heartbeats.hear(beat("amcl", Reported::kDegraded), milliseconds(710));
  heartbeats.judge(milliseconds(710));
  EXPECT_TRUE(heartbeats.degraded());
  EXPECT_EQ(heartbeats.first_lost(Criticality::kStop), nullptr);
}

TEST(HeartbeatTable, DoesNotKnowWhatTheManifestDoesNot) {
  HeartbeatTable heartbeats = table();
  EXPECT_FALSE(heartbeats.hear(beat("rogue"), milliseconds(0)));
  EXPECT_FALSE(heartbeats.hear(beat(""), milliseconds(0)));
  EXPECT_EQ(heartbeats.timeout("people"), milliseconds(300));
  EXPECT_EQ(heartbeats.timeout("rogue"), milliseconds(0));
}

TEST(HeartbeatTable, AnOldHeartbeatUnsaysNoNewerOne) {
  HeartbeatTable heartbeats = table();
  heartbeats.hear(beat("amcl"), milliseconds(1000));
  heartbeats.hear(beat("amcl"), milliseconds(0));
  heartbeats.judge(milliseconds(1050));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kOk);
  heartbeats.hear(beat("amcl", Reported::kFault, 1, kDigest, "no map"), milliseconds(1060));
  heartbeats.hear(beat("amcl", Reported::kOk, 1, kDigest + 1), milliseconds(1040));
  heartbeats.judge(milliseconds(1070));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kFault);
  EXPECT_EQ(heartbeats.find("amcl")->reason, "no map");
  heartbeats.hear(beat("amcl"), milliseconds(1080));
  heartbeats.judge(milliseconds(1080));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kOk);
}

TEST(HeartbeatTable, ARestartIsNoConflictButTwoLivesAre) {
  HeartbeatTable heartbeats = table();
  heartbeats.hear(beat("amcl", Reported::kOk, 1), milliseconds(0));
  heartbeats.hear(beat("amcl", Reported::kOk, 2), milliseconds(50));
  heartbeats.judge(milliseconds(60));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kOk);
  heartbeats.hear(beat("amcl", Reported::kOk, 1), milliseconds(70));
  heartbeats.judge(milliseconds(70));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kFault);
  EXPECT_EQ(heartbeats.find("amcl")->reason, "two live participants have this name");
  heartbeats.hear(beat("amcl", Reported::kOk, 2), milliseconds(0));  // with an old stamp
  heartbeats.judge(milliseconds(70));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kFault);
  for (int ms = 80; ms < 100; ms += 2) {  // so do three
    for (std::uint8_t writer = 4; writer < 7; ++writer)
      heartbeats.hear(beat("people", Reported::kOk, writer), milliseconds(ms));
  }
  heartbeats.judge(milliseconds(100));
  EXPECT_EQ(heartbeats.find("people")->reason, "two live participants have this name");
  for (int ms = 100; ms <= 1100; ms += 50) {  // one of them goes on alone
    heartbeats.hear(beat("amcl", Reported::kOk, 1), milliseconds(ms));
  }
  heartbeats.judge(milliseconds(1100));
  EXPECT_EQ(heartbeats.find("amcl")->health, Health::kOk);
}

TEST(HeartbeatTable, CountsRestarts) {
  HeartbeatTable table({{"amcl", Criticality::kStop, milliseconds(100)}}, kDigest);
  for (std::uint8_t life = 1; life <= 4; ++life) {
    table.hear({"amcl", {life}, kDigest, Reported::kOk, ""}, milliseconds(2000 * life));
  }
  EXPECT_EQ(table.find("amcl")->restarts, 3U);
  table.hear({"amcl", {4}, kDigest, Reported::kOk, "", "nuc", milliseconds(35)},
             milliseconds(8020));
  EXPECT_EQ(table.find("amcl")->host, "nuc");
  EXPECT_EQ(table.find("amcl")->longest_handler, milliseconds(35));
}

}  // namespace
}  // namespace usher::supervisor
