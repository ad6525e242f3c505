#include "runtime/guard/tenure.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string>

namespace usher::runtime {
namespace {

constexpr int kKnockEveryMs = 5;
constexpr int kKnocks = 50;

/// One name for a port, however it is spelt: a device has several, by its number, bus or serial
/// number.
std::string name_of(const StreamAddress& address) {
  struct stat status {};
  std::string target = address.target;
  if (address.socket()) {
    target += ":" + std::to_string(address.number);
  } else if (::stat(target.c_str(), &status) == 0) {
    target = "device " + std::to_string(status.st_rdev);
  }
  return "usher-guard " + target;
}

class SocketAddress {
 public:
  /// The first octet stays zero: a name outside the file system.
  explicit SocketAddress(const std::string& name) {
    address_.sun_family = AF_UNIX;
    const std::size_t count = std::min(name.size(), sizeof(address_.sun_path) - 1);
    std::memcpy(address_.sun_path + 1, name.data(), count);
    size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + count);
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address_); }
  socklen_t size() const { return size_; }

 private:
  sockaddr_un address_{};
  socklen_t size_;
};

}  // namespace

Result<Tenure> Tenure::begin(const StreamAddress& address) {
  const SocketAddress name(name_of(address));
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  int error = descriptor < 0 ? errno : EADDRINUSE;
  for (int i = 0; i < kKnocks && error == EADDRINUSE; ++i) {
    if (::bind(descriptor, name.get(), name.size()) == 0) return Tenure(descriptor);
    error = errno;
    static_cast<void>(::sendto(descriptor, "", 1, 0, name.get(), name.size()));
    ::poll(nullptr, 0, kKnockEveryMs);
  }
  if (descriptor >= 0) ::close(descriptor);
  return Error{error == EADDRINUSE ? "another driver's guard has it" : std::strerror(error)};
}

bool Tenure::take_knock() const {
  char knock = 0;
  return ::recv(descriptor_, &knock, 1, 0) >= 0;
}

}  // namespace usher::runtime
