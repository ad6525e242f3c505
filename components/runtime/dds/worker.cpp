#include "runtime/dds/worker.hpp"

#include <sched.h>

#include <cstring>

namespace usher::runtime {

void Worker::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Worker::submit(std::function<void()> job) {
  {
    const std::scoped_lock lock(mutex_);
    if (stop_) return;
    jobs_.push_back(std::move(job));
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  }
  changed_.notify_one();
}

namespace {

/// The calling thread alone: as an ordinary one, on all processors that its process is permitted.
void leave_real_time() {
  if (sched_getscheduler(0) != SCHED_FIFO) return;
  const sched_param ordinary{};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
  cpu_set_t all;
  std::memset(&all, 0xff, sizeof(all));
  sched_setaffinity(0, sizeof(all), &all);
}

}  // namespace

void Worker::run() {
  leave_real_time();
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return stop_ || !jobs_.empty(); });
    if (stop_) return;
    const auto job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    lock.lock();
  }
}

}  // namespace usher::runtime
