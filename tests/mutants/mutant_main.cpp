// mutant-NAME KIND...: the whole robot with one defect, hit by windows of these kinds of faults.
// Exit code 0 when the judge of the fault windows finds the defect in a window that the robot
// without it keeps every law in, 1 when no window does, 2 when the windows could not be run.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include "operations/experiments/run_jobs.hpp"
#include "operations/fault_windows/window.hpp"

namespace {

using usher::Error;
using usher::Result;

constexpr std::size_t kWindows = 60;
constexpr std::uint64_t kLastSeed = 10'000;

/// The first seeds whose windows are of these kinds.
std::vector<std::uint64_t> seeds_of(const std::set<std::string>& kinds,
                                    const usher::operations::WindowSetting& setting) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = 1; seed <= kLastSeed && seeds.size() < kWindows; ++seed) {
    if (kinds.contains(draw_window(seed, 0, setting.robot_of(seed).targets).kind()))
      seeds.push_back(seed);
  }
  return seeds;
}

/// Whether the robot without the defect keeps every law in this window.
bool kept_without_it(std::uint64_t seed) {
  const std::string name = std::to_string(seed);
  return std::system(("\"" USHER_BINARY_DIR "/bin/usher\" experiment faults --only " + name +
                      " --out \"" USHER_BINARY_DIR "/tests/mutants/control-" + name +
                      "\" > /dev/null")
                         .c_str()) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace usher::operations;
  const auto setting = window_setting(std::string(USHER_BINARY_DIR) + "/share/usher");
  if (!setting) {
    std::printf("%s\n", setting.error().c_str());
    return 2;
  }
  const auto seeds = seeds_of({argv + 1, argv + argc}, *setting);
  std::atomic<bool> killed = false;
  const auto done = run_jobs(seeds.size(), "windows", [&](std::size_t i) -> Result<std::string> {
    if (killed) return std::string();
    const auto window = run_window(*setting, seeds[i]);
    if (!window) return Error{window.error()};
    if (window->judgement.passed()) return std::string();
    if (!kept_without_it(seeds[i]))
      return "seed " + std::to_string(seeds[i]) + " breaks a law without the defect, too\n";
    killed = true;
    return "killed by seed " + std::to_string(window->seed) + ": " + window->plan.text() + ": " +
           window->judgement.violation + "\n";
  });
  if (!done) {
    std::printf("%s\n", done.error().c_str());
    return 2;
  }
  if (!killed) std::printf("survived %zu windows\n", seeds.size());
  return killed ? 0 : 1;
}
