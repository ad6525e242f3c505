#pragma once

#include <memory>
#include <string>

#include "runtime/engine/platform.hpp"

namespace usher::runtime {

/// The streams of one component: one thread that opens them, moves their bytes and opens them anew
/// each second after a failure. The thread starts with the first stream. Addresses are those of
/// StreamAddress; a wrong one is reported once through the sink's `closed`. A sink with a guard
/// gets its bytes through a process usher-guard, which lies beside this program and owns the port.
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
