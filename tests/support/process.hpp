#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <poll.h>
#include <array>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/folder.hpp"
#include "support/sanitizer.hpp"

namespace usher::test {

/// A program that runs beside the test; what it prints can be read at any time. Killed at the end
/// of the scope, with what it started when that watches its parent.
class Process {
 public:
  /// With a terminal (its path) it is somebody's who sits there: reads from it, prints to it, and
  /// is hung up on when it is closed.
  explicit Process(std::vector<std::string> words, const std::string& terminal = "") {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    const int flags = O_WRONLY | O_CREAT | O_APPEND;
    if (terminal.empty()) {
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
      posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, path("output").c_str(), flags,
                                       0600);
    } else {
      posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);  // it becomes the session's
      posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, terminal.c_str(), O_RDWR, 0);
      posix_spawn_file_actions_adddup2(&actions, STDIN_FILENO, STDOUT_FILENO);
    }
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, path("errors").c_str(), flags, 0600);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int error =
        ::posix_spawn(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) pid_ = -1;
  }
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// -1 once it has ended, or when it could not be started.
  pid_t pid() const { return pid_; }
  void signal(int number) const {
    if (pid_ > 0) ::kill(pid_, number);
  }
  /// Exit code; 128 + signal when a signal ended it; -1 when it does not end in time (longer with a
  /// sanitizer).
  int wait(std::chrono::milliseconds limit = std::chrono::seconds(30)) {
    if (pid_ <= 0) return -1;
    const int handle = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
    pollfd entry{handle, POLLIN, 0};
    const int ready =
        ::poll(&entry, 1, static_cast<int>(static_cast<double>(limit.count()) * kSanitizerFactor));
    ::close(handle);
    if (ready <= 0) return -1;
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string output() const { return content_of(path("output")); }
  std::string errors() const { return content_of(path("errors")); }

 private:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  Folder folder_;
  pid_t pid_ = -1;
};

/// The guard of a port that a driver's process has started and that lives; 0 when there is none.
inline pid_t guard_of(pid_t driver) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
    std::ifstream file(entry.path() / "stat");
    pid_t pid = 0, parent = 0;
    std::string name, state;
    if (file >> pid >> name >> state >> parent && parent == driver && name == "(usher-guard)" &&
        state != "Z")
      return pid;
  }
  return 0;
}

}  // namespace usher::test
