#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace usher::runtime {

/// One thread that runs jobs in the order of their submission; it starts with the first. The engine
/// bounds how many are under way. Jobs are long: in a process that runs in real time they run
/// outside of it.
class Worker {
 public:
  Worker() = default;
  ~Worker() { stop(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  void submit(std::function<void()> job);
  /// Waits for the job that runs; the others are dropped, and so is what is submitted after.
  void stop();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace usher::runtime
