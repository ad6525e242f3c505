#pragma once

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/api/time.hpp"

namespace usher::runtime::test {

/// A child process with what it prints; killed at the end of its scope.
class Child {
 public:
  Child(const std::string& program, const std::vector<std::string>& arguments);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) const;
  /// Exit code; 128 + signal when a signal ended it; -1 when it has not ended in time.
  int wait(Duration limit = std::chrono::seconds(20));
  /// Standard output and error, complete after wait().
  const std::string& output() const { return output_; }
  int pid() const { return pid_; }

 private:
  void read_all();
  int pid_ = -1;
  int pipe_ = -1;
  std::string output_;
};

/// A file in a folder of its own, removed at the end of its scope.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string path() const { return path_; }
  /// Writes a file and returns its path.
  std::string file(const std::string& name, const std::string& content) const;

 private:
  std::string path_;
};

}  // namespace usher::runtime::test
