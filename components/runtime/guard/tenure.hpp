#pragma once

#include <string>

#include "foundation/result/result.hpp"

namespace usher::runtime {

/// One guard at a time has a port, root's as well: while it does, an abstract socket has the port's
/// address for its name. Who wants the port next knocks there.
class Tenure {
 public:
  /// Knocks until the port is free: a guard whose driver ended goes within 0.1 s. The error says
  /// that another driver has the port.
  static Result<Tenure> begin(const std::string& address);

  /// To poll for reading: somebody knocks.
  int descriptor() const { return descriptor_; }
  /// Somebody knocked since the last call.
  bool wanted() const;

 private:
  explicit Tenure(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;  // closed by the process's end
};

}  // namespace usher::runtime
