#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "idl/topics.hpp"
#include "runtime/dds/observer.hpp"
#include "support/process.hpp"
#include "support/test_domain.hpp"

namespace usher::test {

using Seconds = std::chrono::duration<double>;

/// The program that a user types.
std::string usher_program();

/// How much slower than alone a busy thread runs on this machine right now, 1 to 5: wall time over
/// processor time of a reference loop. Bounds of wall time are multiplied with it.
double slowdown();

/// A world that was late once says so for ever, since its run no longer counts; the robot is well.
bool is_well(const usher_msgs::msg::ComponentHealth& component);

/// Names and processes of the components that were launched from a folder.
std::map<std::string, pid_t> components_from(const std::string& folder);
/// Files in /dev/shm that these processes have mapped or opened.
std::set<std::string> shared_memory_of(const std::map<std::string, pid_t>& processes);

/// MARVIN in simulation, or what another manifest of deploy/ has, launched by `usher launch` from a
/// manifest in a folder of its own, in a DDS domain that no other test of this machine uses; and
/// somebody who listens. The default run directory lies in the folder too, for this and all
/// programs that the test starts.
class RunningRobot {
 public:
  /// What was last heard of a component.
  struct Life {
    runtime::Guid writer{};
    std::uint8_t state = 0;
    std::string reason;
    std::chrono::steady_clock::time_point at;  ///< of the first heartbeat of this writer
  };

  /// A secure robot has keys of its own, in folder()/deploy/keys; its observer is the operator.
  explicit RunningRobot(bool secure = false, const std::string& base = "marvin-sim.yaml")
      : RunningRobot(test_domain(), secure, base, secure ? "security: keys\n" : "") {}
  /// A robot of a fleet, beside others of the same test; `more` is the rest of its manifest.
  RunningRobot(std::uint32_t domain, const std::string& base, const std::string& more)
      : RunningRobot(domain, false, base, more) {}
  ~RunningRobot();

  /// Launches; the former launcher must have ended. `before` is a program that becomes the
  /// launcher, with its arguments, `after` are more options of it.
  void launch(const std::vector<std::string>& before = {},
              const std::vector<std::string>& after = {});
  Process& launcher() { return *launcher_; }
  const std::string& manifest() const { return manifest_; }
  const std::string& folder() const { return folder_.path(); }
  std::string keys() const { return folder_.path() + "/deploy/keys"; }
  std::uint32_t domain() const { return domain_; }
  runtime::Observer& observer() { return *observer_; }
  std::map<std::string, pid_t> components() const { return components_from(folder_.path()); }

  /// A command of the program for this robot: its name, arguments and `--domain N`; at a terminal
  /// where one is given.
  std::unique_ptr<Process> command(std::vector<std::string> words,
                                   const std::string& terminal = "") const;

  std::optional<usher_msgs::msg::SupervisorStatus> status() const;
  /// Within the last second.
  bool hears_supervisor() const;
  /// How often the supervisor was heard since the start.
  std::size_t status_count() const;
  std::map<std::string, Life> lives() const;
  /// Everybody is healthy in the supervisor's eyes (a late simulation is nobody's illness), and the
  /// robot may drive.
  bool may_drive() const;
  /// Who is not, in words.
  std::string complaints() const;
  /// The supervisor's faults, those that are over too, a line for each.
  std::string fault_story() const;

  /// Asks the condition after each message and now and then; false when the limit passes, which is
  /// longer with a sanitizer.
  bool wait_for(const std::function<bool()>& condition, Seconds limit) const;

 private:
  RunningRobot(std::uint32_t domain, bool secure, const std::string& base, const std::string& more);

  Folder folder_;
  std::uint32_t domain_;
  std::string manifest_;
  std::unique_ptr<Process> launcher_;

  mutable std::mutex mutex_;
  mutable std::condition_variable heard_;
  std::optional<usher_msgs::msg::SupervisorStatus> status_;
  std::chrono::steady_clock::time_point status_at_{};
  std::size_t status_count_ = 0;
  std::map<std::string, Life> lives_;

  std::unique_ptr<runtime::Observer> observer_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::Heartbeat>> heartbeats_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::SupervisorStatus>> statuses_;
};

}  // namespace usher::test
