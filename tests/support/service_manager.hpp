#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cassert>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "support/folder.hpp"

namespace usher::test {

/// Stands for systemd: the socket that a service notifies, in the environment of this process and
/// of those that it starts.
class ServiceManager {
 public:
  explicit ServiceManager(std::chrono::microseconds watchdog)
      : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const std::string path = folder_.path() + "/notify";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
    const int bound = ::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address));
    assert(bound == 0);
    static_cast<void>(bound);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    ::setenv("WATCHDOG_USEC", std::to_string(watchdog.count()).c_str(), 1);
  }
  ~ServiceManager() {
    ::unsetenv("NOTIFY_SOCKET");
    ::unsetenv("WATCHDOG_USEC");
    ::close(socket_);
  }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// Since the last call.
  std::vector<std::string> heard() const {
    std::vector<std::string> all;
    char text[512];
    for (ssize_t size = 0; (size = ::recv(socket_, text, sizeof(text), 0)) > 0;)
      all.emplace_back(text, static_cast<std::size_t>(size));
    return all;
  }

 private:
  Folder folder_;
  int socket_;
};

}  // namespace usher::test
