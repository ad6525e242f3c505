#include "operations/command_line/robot.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

TEST(MeantDomain, IsWhatWasGiven) {
  const auto meant = meant_domain(7U, {7, 42});
  EXPECT_EQ(meant.domain, 7U);
  EXPECT_EQ(meant.remark, "");
  EXPECT_EQ(meant_domain(7U, {}).domain, 7U);
  EXPECT_EQ(meant_domain(7U, {}).remark, "") << "the robot may be on another machine";
}

TEST(MeantDomain, IsThatOfTheOnlyRobot) {
  const auto meant = meant_domain(std::nullopt, {42});
  EXPECT_EQ(meant.domain, 42U);
  EXPECT_EQ(meant.remark, "in domain 42, where the only robot of this machine was launched");
  EXPECT_EQ(meant_domain(std::nullopt, {0}).remark, "");
  EXPECT_EQ(meant_domain(std::nullopt, {}).domain, 0U);
  EXPECT_EQ(meant_domain(std::nullopt, {}).remark, "");
}

TEST(MeantDomain, SaysWhereTheRobotsAreInstead) {
  const auto meant = meant_domain(7U, {42, 43});
  EXPECT_EQ(meant.domain, 7U);
  EXPECT_EQ(
      meant.remark,
      "no robot was launched on this machine in domain 7; one was in domain 42 (--domain 42), "
      "one in domain 43 (--domain 43)");
  EXPECT_EQ(meant_domain(std::nullopt, {42, 43}).domain, 0U)
      << "which of them is not to be guessed";
  EXPECT_TRUE(meant_domain(std::nullopt, {42, 43})
                  .remark.starts_with("no robot was launched on this machine in domain 0; "));
  EXPECT_EQ(meant_domain(std::nullopt, {0, 42}).remark,
            "in domain 0; one was in domain 42 (--domain 42)");
}

TEST(NobodyWrites, SaysWhichTopicWasMeant) {
  EXPECT_EQ(nobody_writes("scans", 7, {"odom", "scan", "scan/filtered"}),
            "nobody writes scans in domain 7; did you mean scan?");
  EXPECT_EQ(nobody_writes("scan", 7, {"odom"}), "nobody writes scan in domain 7");
}

TEST(JudgePace, IsThatOfTheRobot) {
  EXPECT_TRUE(judge_pace(0.3, 1.4F));
  EXPECT_TRUE(judge_pace(1.4, 1.4F)) << "as the wire rounds it";
  const auto refused = judge_pace(1.5, 1.4F);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "--max-speed must be at most this robot's 1.40 m/s, got 1.5 m/s");
}

}  // namespace
}  // namespace usher::operations
