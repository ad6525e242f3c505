#include "operations/experiments/run_jobs.hpp"

#include <gtest/gtest.h>

namespace usher::operations {
namespace {

TEST(RunJobs, SaysAtOnceHowManyThereAre) {
  testing::internal::CaptureStderr();  // no terminal: a line a minute, the first one at once
  EXPECT_TRUE(run_jobs(3, "visits", [](std::size_t) { return Result<std::string>(""); }));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "0 of 3 visits\n");
}

TEST(RunJobs, EndsWithTheFirstError) {
  const auto status = run_jobs(100, "visits", [](std::size_t i) -> Result<std::string> {
    if (i == 0) return Error{"no map"};
    return std::string();
  });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error(), "no map");
}

}  // namespace
}  // namespace usher::operations
