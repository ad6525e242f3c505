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

}  // namespace
}  // namespace usher::operations
