#pragma once

#include <map>
#include <memory>
#include <string>

#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::operations {

/// A whole deployment in one thread on a virtual clock, with a judge's record beside it. The same
/// deployment and seed give the same bytes.
class LockstepRun {
 public:
  /// Fails with the deployment's first finding, an unknown component type, or what a component says
  /// of its parameters.
  static Result<std::unique_ptr<LockstepRun>> create(const Deployment& deployment,
                                                     std::uint64_t seed);

  runtime::LockstepWorld& world() { return world_; }
  const RunRecord& record() const { return record_; }
  /// What components that are not well say of themselves now, and what they rejected, one a line.
  std::string complaints() const;
  /// Another goal: a new record, the world goes on.
  void restart_record() { record_ = {}; }

 private:
  explicit LockstepRun(std::uint64_t seed);

  runtime::LockstepWorld world_;
  RunRecord record_;
  std::map<std::string, usher_msgs::msg::Heartbeat> heartbeats_;
};

}  // namespace usher::operations
