// Two hundred seeded windows in which something goes wrong while the whole robot drives among
// people: the judge finds no broken law. The seeds are those of `usher experiment faults`.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <mutex>
#include <string>

#include "operations/experiments/run_jobs.hpp"
#include "operations/fault_windows/window.hpp"

namespace usher::operations {
namespace {

constexpr std::size_t kWindows = 200;
const std::string kShare = std::string(USHER_BINARY_DIR) + "/share/usher";

TEST(FaultWindows, BreakNoLaw) {
  const auto setting = window_setting(kShare);
  ASSERT_TRUE(setting.ok()) << setting.error();
  std::mutex mutex;
  std::string broken;
  std::map<std::string, int> ends, kinds;
  double slowest = 1e9;
  const auto done = run_jobs(kWindows, "windows", [&](std::size_t i) -> Result<std::string> {
    const auto window = run_window(*setting, i + 1);
    if (!window) return Error{window.error()};
    const std::lock_guard lock(mutex);
    ++ends[std::string(text(window->judgement.end))];
    ++kinds[window->plan.kind()];
    slowest = std::min(slowest, window->hit_speed);
    if (!window->judgement.passed()) {
      broken += "seed " + std::to_string(window->seed) + ": " + window->plan.text() + ": " +
                window->judgement.violation + " (replay: usher experiment faults --only " +
                std::to_string(window->seed) + ")\n";
    }
    return std::string();
  });
  ASSERT_TRUE(done.ok()) << done.error();
  for (const auto& [end, count] : ends) std::printf("%s: %d\n", end.c_str(), count);
  EXPECT_EQ(broken, "");
  EXPECT_GT(slowest, kHitSpeed) << "no window is empty";
  EXPECT_EQ(kinds.size(), kFaultKinds + 1) << "every kind of fault was there";
}

TEST(FaultWindows, GiveTheSameBytesForTheSameSeed) {
  const auto setting = window_setting(kShare);
  ASSERT_TRUE(setting.ok()) << setting.error();
  const auto once = run_window(*setting, 1), again = run_window(*setting, 1);
  ASSERT_TRUE(once.ok() && again.ok());
  EXPECT_EQ(once->digest, again->digest);
}

}  // namespace
}  // namespace usher::operations
