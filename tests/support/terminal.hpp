#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cassert>
#include <string>

namespace usher::test {

/// A pseudo terminal: the window that a user types into. For one program at a time.
class Terminal {
 public:
  Terminal() : window_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK)) {
    [[maybe_unused]] const bool made =
        window_ >= 0 && ::grantpt(window_) == 0 && ::unlockpt(window_) == 0;
    assert(made);
    char name[64] = {};
    ::ptsname_r(window_, name, sizeof name);
    path_ = name;
  }
  ~Terminal() { close(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// For the program.
  const std::string& path() const { return path_; }
  void type(const std::string& keys) const {
    static_cast<void>(!::write(window_, keys.data(), keys.size()));
  }
  /// All that was printed so far. A program that prints waits for somebody who asks.
  const std::string& text() {
    char bytes[4096];
    for (ssize_t size; (size = ::read(window_, bytes, sizeof bytes)) > 0;)
      text_.append(bytes, static_cast<std::size_t>(size));
    return text_;
  }
  /// The window is closed: the program is hung up on.
  void close() {
    if (window_ >= 0) ::close(window_);
    window_ = -1;
  }

 private:
  int window_;
  std::string path_, text_;
};

}  // namespace usher::test
