#pragma once

#include <memory>
#include <string>

#include "foundation/result/result.hpp"
#include "runtime/engine/platform.hpp"

namespace usher::runtime {

/// What a stream's address says: "tcp://192.168.1.2:2112" (numeric IPv4 or localhost) or
/// "serial:///dev/ttyUSB0?baud=115200" (8 data bits, no parity, 1 stop bit, raw).
struct StreamAddress {
  bool serial = false;
  std::string target;  ///< address or device
  int number = 0;      ///< port or baud rate

  static Result<StreamAddress> parse(const std::string& uri);
};

/// The streams of one component: one thread that opens them, moves their bytes and opens them anew
/// each second after a failure. The thread starts with the first stream. A wrong address is
/// reported once through the sink's `closed`.
class Streams {
 public:
  Streams();
  /// Closes all streams; no sink is called after it returns.
  ~Streams();
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;

  /// Lives as long as this object.
  Stream& open(const std::string& uri, StreamSink sink);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace usher::runtime
