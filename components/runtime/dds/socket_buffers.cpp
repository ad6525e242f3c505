#include "runtime/dds/socket_buffers.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string>

namespace usher::runtime {
namespace {

/// Bytes of the receive buffer when `descriptor` is a UDP socket of the domain, else `otherwise`.
std::uint32_t receive_buffer(int descriptor, std::uint32_t domain, std::uint32_t otherwise) {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  int type = 0;
  socklen_t type_size = sizeof(type);
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM)
    return otherwise;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return otherwise;
  const std::uint32_t first = 7400 + 250 * domain;  // the port mapping of RTPS
  const std::uint32_t port = ntohs(address.sin_port);
  if (address.sin_family != AF_INET || port < first || port >= first + 250) return otherwise;
  int bytes = 0;
  socklen_t bytes_size = sizeof(bytes);
  if (getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &bytes, &bytes_size) != 0) return otherwise;
  return static_cast<std::uint32_t>(bytes) / 2;  // Linux reports twice what it granted
}

}  // namespace

void warn_of_small_socket_buffers(std::uint32_t domain, std::uint32_t wanted) {
  static std::atomic<bool> warned{false};
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const std::string name = entry.path().filename();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    const std::uint32_t granted = receive_buffer(descriptor, domain, wanted);
    if (granted >= wanted || warned.exchange(true)) continue;
    std::fprintf(
        stderr,
        "warning: UDP receive buffers have %u bytes, %u are wanted: large messages will be lost. "
        "Run: sysctl -w net.core.rmem_max=%u net.core.wmem_max=%u\n",
        granted, wanted, wanted, wanted);
  }
}

}  // namespace usher::runtime
