#pragma once

#include <memory>

#include "foundation/result/result.hpp"
#include "runtime/api/host.hpp"
#include "runtime/engine/engine.hpp"
#include "runtime/parameters/parameter_file.hpp"

namespace usher::runtime {

/// Asks hosts to stop: once set it stays set. May be set in a signal handler.
class StopFlag {
 public:
  StopFlag();
  ~StopFlag();
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;

  void set();
  /// Readable when it is set.
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

/// Runs one component as a DDS participant. The thread that calls run() is the dispatcher: every
/// handler runs there.
class DdsHost {
 public:
  /// `stop` must outlive the host.
  static Result<std::unique_ptr<DdsHost>> create(ParameterFile file, const StopFlag& stop);
  /// The participant leaves the domain.
  ~DdsHost();

  /// Makes the component; then it can receive, but no handler runs before run().
  Status construct(const ComponentFactory& factory);
  /// Handlers run until the stop flag is set or the component ends. Exit code of a program: 0 asked
  /// to stop, 3 fault.
  int run();

  Engine& engine();

 private:
  class Implementation;
  explicit DdsHost(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace usher::runtime
