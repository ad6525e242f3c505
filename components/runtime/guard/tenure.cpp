#include "runtime/guard/tenure.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace usher::runtime {
namespace {

constexpr int kKnockEveryMs = 5;
constexpr int kKnocks = 50;

struct Name {
  explicit Name(const std::string& address) {
    const std::string text = "usher-guard " + address;
    socket.sun_family = AF_UNIX;
    // The first octet stays zero: a name outside the file system.
    const std::size_t count = std::min(text.size(), sizeof(socket.sun_path) - 1);
    std::memcpy(socket.sun_path + 1, text.data(), count);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + count);
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&socket); }
  sockaddr_un socket{};
  socklen_t size;
};

}  // namespace

Result<Tenure> Tenure::begin(const std::string& address) {
  const Name name(address);
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  for (int i = 0; i < kKnocks && descriptor >= 0; ++i) {
    if (::bind(descriptor, name.get(), name.size) == 0) return Tenure(descriptor);
    if (errno != EADDRINUSE) break;
    static_cast<void>(::sendto(descriptor, "", 1, 0, name.get(), name.size));
    ::poll(nullptr, 0, kKnockEveryMs);
    errno = EADDRINUSE;
  }
  if (errno == EADDRINUSE)
    return Error{"cannot open " + address + ": the guard of another driver has it"};
  return Error{"cannot open " + address + ": no socket in its name: " + std::strerror(errno)};
}

bool Tenure::wanted() const {
  char knock = 0;
  bool any = false;
  while (::recv(descriptor_, &knock, 1, 0) >= 0) any = true;
  return any;
}

}  // namespace usher::runtime
