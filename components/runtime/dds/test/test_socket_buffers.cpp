#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "runtime/dds/socket_buffers.hpp"
#include "support/test_domain.hpp"

namespace usher::runtime {
namespace {

/// A UDP socket with a port of the domain and a receive buffer of this size.
class Socket {
 public:
  explicit Socket(int bytes) : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof(bytes));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * test_domain() + 240));
    EXPECT_EQ(::bind(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
  }
  ~Socket() { ::close(descriptor_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

 private:
  int descriptor_;
};

std::string warning(std::uint32_t domain, std::uint32_t wanted) {
  testing::internal::CaptureStderr();
  warn_of_small_socket_buffers(domain, wanted);
  return testing::internal::GetCapturedStderr();
}

TEST(SocketBuffers, AreReportedOnceWhenTheKernelGrantedLess) {
  const Socket socket(65536);
  EXPECT_EQ(warning(test_domain(), 65536), "");
  EXPECT_EQ(warning(test_domain() + 1, 1U << 20), "");  // a socket of somebody else
  const std::string text = warning(test_domain(), 1U << 20);
  EXPECT_THAT(text, testing::HasSubstr("have 65536 bytes, 1048576 are wanted"));
  EXPECT_THAT(text, testing::HasSubstr("sysctl -w net.core.rmem_max=1048576"));
  EXPECT_EQ(warning(test_domain(), 1U << 20), "");
}

}  // namespace
}  // namespace usher::runtime
