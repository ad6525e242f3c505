#include "operations/experiments/only.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

const std::vector<std::string> kNames{"follows", "lace", "short", "short_2_robots"};

std::string run(const std::string& text) {
  const auto only = only_run_of(text, kNames);
  return only ? only->name + " " + std::to_string(only->number) : only.error();
}

TEST(Only, TakesAllWhereNothingIsSaid) {
  const auto all = only_of("", kNames);
  ASSERT_TRUE(all);
  EXPECT_TRUE(all->takes("lace"));
  EXPECT_EQ(run(""), " 0");
}

TEST(Only, IsOneOfTheNames) {
  const auto lace = only_of("lace", kNames);
  ASSERT_TRUE(lace);
  EXPECT_TRUE(lace->takes("lace"));
  EXPECT_FALSE(lace->takes("follows"));
  EXPECT_EQ(only_of("lase", kNames).error(),
            "--only takes follows, lace, short or short_2_robots, not lase; did you mean lace?");
  EXPECT_FALSE(only_of("lace_5", kNames));
}

TEST(Only, IsOneRunOfThem) {
  EXPECT_EQ(run("lace"), "lace 0");
  EXPECT_EQ(run("lace_5"), "lace 5");
  EXPECT_EQ(run("short_2_robots"), "short_2_robots 0");
  EXPECT_EQ(run("short_2_robots_7"), "short_2_robots 7");
  for (const std::string wrong :
       {"lase_5", "lace_", "lace_0", "lace_-1", "lace_5x", "lace_1000001", "_5", "5"}) {
    EXPECT_EQ(run(wrong).find("--only takes follows, lace, short or short_2_robots, or one run as "
                              "follows_5, not " +
                              wrong),
              0U)
        << run(wrong);
  }
}

TEST(OnlySeed, IsAWholeNumberFromOneOn) {
  EXPECT_EQ(only_seed("").value(), 0U);
  EXPECT_EQ(only_seed("17").value(), 17U);
  for (const std::string wrong : {"0", "-1", "x", "5x", "1.5"})
    EXPECT_EQ(only_seed(wrong).error(), "--only takes a seed from 1 on, not " + wrong);
}

}  // namespace
}  // namespace usher::operations
