#pragma once

#include <functional>
#include <memory>
#include <string>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/run_record.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

/// How an errand ended.
struct Arrival {
  bool reported = false;  ///< the navigator says that the robot is there
  std::string reason;     ///< else: why not
};

/// A whole deployment that an operator may send about, in lock-step or as processes.
class CommandedRobot {
 public:
  virtual ~CommandedRobot() = default;

  /// To one of the site's locations. Blocks until the errand is over, or the time [s] of the robot
  /// is up. An error is a deployment that does not run; a robot that does not arrive is a result.
  virtual Result<Arrival> send(const std::string& location, double longest) = 0;
  /// What happened since the last call.
  virtual RunRecord take_record() = 0;
  /// What components say of themselves that are not well now, one a line; empty where unknown.
  virtual std::string complaints() const { return {}; }
  /// [s] of the robot's time since it was started.
  virtual double elapsed() const = 0;
  /// [s] of one processor spent on it so far, where the robot is one thread; else 0.
  virtual double processor_time() const { return 0.0; }
};

class LockstepRun;

/// In this thread, on a virtual clock. `watch` is shown the run before anything has happened; it
/// lives as long as the robot.
Result<std::unique_ptr<CommandedRobot>> lockstep_robot(
    const Deployment& deployment, std::uint64_t seed,
    const std::function<void(LockstepRun&)>& watch = {});
/// As real DDS processes, on the wall clock; the launcher keeps its state in `run_directory`.
Result<std::unique_ptr<CommandedRobot>> process_robot(Deployment deployment, std::uint64_t seed,
                                                      const Installation& installation,
                                                      std::uint32_t domain,
                                                      const std::string& run_directory);

}  // namespace usher::operations
