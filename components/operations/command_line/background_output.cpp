#include "operations/command_line/background_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace usher::operations {

struct BackgroundOutput::State {
  explicit State(int output) : descriptor(::fcntl(output, F_DUPFD_CLOEXEC, 0)) {}
  ~State() { ::close(descriptor); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  bool idle() const { return waiting.empty() && writing == 0; }

  const int descriptor;
  mutable std::mutex mutex;
  std::condition_variable changed;
  std::string waiting;
  std::size_t writing = 0;  ///< bytes in the thread's hands
  std::int64_t lost_lines = 0;
  bool ended = false;
};

namespace {

void write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(descriptor, text.data(), text.size());
    if (count >= 0) {
      text.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {  // somebody who shares it wants no waiting
      pollfd entry{descriptor, POLLOUT, 0};
      ::poll(&entry, 1, -1);
    } else if (errno != EINTR) {
      return;
    }
  }
}

}  // namespace

BackgroundOutput::BackgroundOutput(int descriptor) : state_(std::make_shared<State>(descriptor)) {
  std::thread([state = state_] {
    // Signals are for the others, and a reader that has gone is an error here, no end.
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    std::unique_lock lock(state->mutex);
    while (true) {
      state->changed.wait(lock, [&] { return !state->waiting.empty() || state->ended; });
      if (state->waiting.empty()) return;
      const std::string text = std::exchange(state->waiting, {});
      state->writing = text.size();
      lock.unlock();
      write_all(state->descriptor, text);
      lock.lock();
      state->writing = 0;
      state->changed.notify_all();
    }
  }).detach();  // nobody could wait for one that is held up
}

BackgroundOutput::~BackgroundOutput() {
  std::unique_lock lock(state_->mutex);
  state_->ended = true;
  state_->changed.notify_all();
  state_->changed.wait_for(lock, kFarewell, [this] { return state_->idle(); });
}

void BackgroundOutput::say(std::string_view text) {
  if (text.empty()) return;
  const std::lock_guard lock(state_->mutex);
  std::string all;
  if (state_->lost_lines > 0)
    all = "(" + std::to_string(state_->lost_lines) + " lines are missing: nobody read them)\n";
  all += text;
  if (state_->waiting.size() + state_->writing + all.size() > kMostBytes) {
    state_->lost_lines += std::count(text.begin(), text.end(), '\n');
    return;
  }
  state_->lost_lines = 0;
  state_->waiting += all;
  state_->changed.notify_all();
}

bool BackgroundOutput::idle() const {
  const std::lock_guard lock(state_->mutex);
  return state_->idle();
}

}  // namespace usher::operations
