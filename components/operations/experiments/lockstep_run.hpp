#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"
#include "runtime/lockstep/lockstep_world.hpp"

namespace usher::operations {

/// A whole deployment, or those of the robots of a fleet, in one thread on a virtual clock, with a
/// judge's record beside each robot. The same deployments and seed give the same bytes.
class LockstepRun {
 public:
  /// Fails with the deployment's first finding, an unknown component type, or what a component says
  /// of its parameters.
  static Result<std::unique_ptr<LockstepRun>> create(const Deployment& deployment,
                                                     std::uint64_t seed);
  static Result<std::unique_ptr<LockstepRun>> create(std::span<const Deployment> fleet,
                                                     std::uint64_t seed);

  runtime::LockstepWorld& world() { return world_; }
  /// Of a robot of the fleet; without a name, of the only one.
  const RunRecord& record(const std::string& robot = {}) const { return records_.at(robot); }
  /// What components that are not well say of themselves now, and what they rejected, one a line.
  std::string complaints() const;
  /// Of a component's newest heartbeat; in a fleet its name is "robot/component". Zero when nothing
  /// was counted.
  std::uint64_t counter(const std::string& component, const std::string& name) const;
  /// Another goal: a new record, the world goes on.
  void restart_record() {
    for (auto& [robot, record] : records_) record = {};
  }

 private:
  explicit LockstepRun(std::uint64_t seed);
  void watch(const std::string& robot);
  Status add(const Deployment& deployment, std::uint64_t seed);

  runtime::LockstepWorld world_;
  std::map<std::string, RunRecord> records_;                      ///< by robot
  std::map<std::string, usher_msgs::msg::Heartbeat> heartbeats_;  ///< by name in the world
};

}  // namespace usher::operations
