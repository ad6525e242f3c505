#include "operations/experiments/run_jobs.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>
#include <vector>

#include "operations/experiments/experiment.hpp"

namespace usher::operations {

void show_progress(const std::string& line) {
  if (isatty(STDERR_FILENO) != 0) {
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    return;
  }
  using Clock = std::chrono::steady_clock;
  static Clock::time_point due;  // the first line at once
  if (line.empty() || Clock::now() < due) return;
  due = Clock::now() + std::chrono::minutes(1);
  std::fprintf(stderr, "%s\n", line.c_str());
}

Status run_jobs(std::size_t count, const std::string& what,
                const std::function<Result<std::string>(std::size_t)>& job) {
  std::mutex mutex;
  std::size_t next = 0, done = 0;
  std::string error;
  const auto work = [&] {
    std::unique_lock lock(mutex);
    while (next < count) {
      const std::size_t i = next++;
      lock.unlock();
      const auto said = job(i);
      lock.lock();
      if (!said) {
        if (error.empty()) error = said.error();
        next = count;
        return;
      }
      if (!said->empty()) {
        show_progress("");
        std::fputs(said->c_str(), stdout);
        std::fflush(stdout);
      }
      show_progress(std::to_string(++done) + " of " + std::to_string(count) + " " + what);
    }
  };
  show_progress("0 of " + std::to_string(count) + " " + what);
  {
    const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < std::min(count, processors); ++i) threads.emplace_back(work);
  }
  show_progress("");
  if (!error.empty()) return Error{error};
  return {};
}

}  // namespace usher::operations
