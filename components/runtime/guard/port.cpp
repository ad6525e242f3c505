#include "runtime/guard/port.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>

namespace usher::runtime {
namespace {

const std::map<int, speed_t>& baud_rates() {
  static const std::map<int, speed_t> rates = {
      {9600, B9600},     {19200, B19200},    {38400, B38400},   {57600, B57600},
      {115200, B115200}, {230400, B230400},  {460800, B460800}, {500000, B500000},
      {921600, B921600}, {1000000, B1000000}};
  return rates;
}

std::optional<int> whole_number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Closes it and keeps the error that made it useless.
int failed(int descriptor) {
  const int error = errno;
  ::close(descriptor);
  errno = error;
  return -1;
}

int open_socket(const StreamAddress& address) {
  const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  const int yes = 1;
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<std::uint16_t>(address.number));
  inet_pton(AF_INET, address.target.c_str(), &where.sin_addr);
  const auto* name = reinterpret_cast<const sockaddr*>(&where);
  if (address.kind == StreamAddress::Kind::kListen) {
    ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    if (::bind(descriptor, name, sizeof(where)) == 0 && ::listen(descriptor, 4) == 0)
      return descriptor;
    return failed(descriptor);
  }
  ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
  if (::connect(descriptor, name, sizeof(where)) == 0 || errno == EINPROGRESS) return descriptor;
  return failed(descriptor);
}

int open_serial(const StreamAddress& address) {
  const int descriptor = ::open(address.target.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return -1;
  termios settings{};
  if (::ioctl(descriptor, TIOCEXCL) == 0 && ::tcgetattr(descriptor, &settings) == 0) {
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
    const speed_t speed = baud_rates().at(address.number);
    ::cfsetispeed(&settings, speed);
    ::cfsetospeed(&settings, speed);
    if (::tcsetattr(descriptor, TCSANOW, &settings) == 0) {
      ::tcflush(descriptor, TCIOFLUSH);
      return descriptor;
    }
  }
  return failed(descriptor);
}

}  // namespace

Result<StreamAddress> StreamAddress::parse(const std::string& uri) {
  const Error error{
      "a stream is tcp://ADDRESS:PORT, listen://ADDRESS:PORT, serial:///DEVICE?baud=RATE or "
      "device:///DEVICE, found '" +
      uri + "'"};
  const std::size_t scheme = uri.find("://");
  if (scheme == std::string::npos) return error;
  const std::string kind = uri.substr(0, scheme);
  const std::string rest = uri.substr(scheme + 3);
  if ((kind == "serial" || kind == "device") && !rest.starts_with('/')) {
    return Error{"a device is a path from the root, such as " + kind + ":///dev/ttyUSB0" +
                 (kind == "serial" ? "?baud=115200" : "") + ", found '" + uri + "'"};
  }
  StreamAddress address;
  if (kind == "tcp" || kind == "listen") {
    address.kind = kind == "tcp" ? Kind::kTcp : Kind::kListen;
    const std::size_t colon = rest.rfind(':');
    if (colon == std::string::npos || colon == 0) return error;
    address.target = rest.substr(0, colon);
    if (address.target == "localhost") address.target = "127.0.0.1";
    in_addr ignored{};
    const auto port = whole_number(std::string_view(rest).substr(colon + 1));
    if (inet_pton(AF_INET, address.target.c_str(), &ignored) != 1 || !port || *port < 1 ||
        *port > 65535)
      return error;
    address.number = *port;
    return address;
  }
  if (kind == "serial") {
    address.kind = Kind::kSerial;
    const std::size_t question = rest.find("?baud=");
    if (question == std::string::npos) return error;
    address.target = rest.substr(0, question);
    const auto baud = whole_number(std::string_view(rest).substr(question + 6));
    if (!baud || !baud_rates().contains(*baud)) return error;
    address.number = *baud;
    return address;
  }
  if (kind == "device") {
    address.kind = Kind::kDevice;
    address.target = rest;
    return address;
  }
  return error;
}

bool line_full(int descriptor) {
  constexpr int kMost = 64;  // bytes; 1.4 ms at 460800 baud, 5.6 ms at 115200
  int unsent = 0;
  return ::isatty(descriptor) == 1 && ::ioctl(descriptor, TIOCOUTQ, &unsent) == 0 && unsent > kMost;
}

int open_port(const StreamAddress& address) {
  switch (address.kind) {
    case StreamAddress::Kind::kTcp:
    case StreamAddress::Kind::kListen:
      return open_socket(address);
    case StreamAddress::Kind::kSerial:
      return open_serial(address);
    case StreamAddress::Kind::kDevice:
      return ::open(address.target.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  }
  return -1;
}

}  // namespace usher::runtime
