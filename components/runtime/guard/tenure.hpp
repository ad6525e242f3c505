#pragma once

#include "foundation/result/result.hpp"
#include "runtime/guard/port.hpp"

namespace usher::runtime {

/// One guard at a time has a port, root's as well: an abstract socket of the port's name is its
/// sign. Who wants the port next knocks there. It ends with the process.
class Tenure {
 public:
  /// Knocks until the port is free: a guard whose driver ended goes within 0.1 s. The error says
  /// that somebody has the port.
  static Result<Tenure> begin(const StreamAddress& address);

  /// To poll for reading: somebody knocks.
  int descriptor() const { return descriptor_; }
  /// Takes one knock; false where nobody did.
  bool take_knock() const;

 private:
  explicit Tenure(int descriptor) : descriptor_(descriptor) {}
  int descriptor_;
};

}  // namespace usher::runtime
