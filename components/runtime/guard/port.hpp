#pragma once

#include <string>

#include "foundation/result/result.hpp"

namespace usher::runtime {

/// What a stream's address says:
///
///     tcp://192.168.1.2:2112             numeric IPv4 or localhost
///     listen://127.0.0.1:2112            waits there for the other side, one at a time
///     serial:///dev/ttyUSB0?baud=115200  8 data bits, no parity, 1 stop bit, raw
///     device:///dev/input/js0            a character device, read only
struct StreamAddress {
  enum class Kind { kTcp, kListen, kSerial, kDevice };
  Kind kind = Kind::kTcp;
  std::string target;  ///< address or device
  int number = 0;      ///< port or baud rate

  bool socket() const { return kind == Kind::kTcp || kind == Kind::kListen; }
  static Result<StreamAddress> parse(const std::string& uri);
};

/// Opens the port without blocking: a descriptor, or -1 and errno. A TCP connection may still be
/// under way (writable when it is decided), a listening one waits for accept().
int open_port(const StreamAddress& address);

/// A serial line whose driver holds more than two or three commands that are not sent yet. What is
/// written now would wait behind them, and no poll() says when they are gone. False for any other
/// port.
bool line_full(int descriptor);

}  // namespace usher::runtime
