#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "foundation/result/result.hpp"
#include "operations/manifest/resolve.hpp"

namespace usher::operations {

struct LaunchOptions {
  std::string host;  ///< start only this host's part; empty = everything on this machine
  std::string program_directory;  ///< where usher-<type> lie
  std::string
      run_directory;  ///< parameter files, logs and what components keep; made when it is not there
};

/// One process of a deployment: a component, or a group of them.
struct Process {
  enum class State {
    kWaiting,  ///< to be started at `start_at`
    kRunning,
    kStopping,
    kStopped,  ///< asked to
    kGaveUp,   ///< restarts are not wanted or used up, or its parameters are wrong
  };

  std::string name;                     ///< of the component, or of the group
  std::vector<std::string> components;  ///< names
  std::vector<std::string> arguments;   ///< program first
  RestartPolicy restart = RestartPolicy::kAlways;
  int budget = 0;                                  ///< starts within a minute
  Criticality criticality = Criticality::kNotify;  ///< the highest of its components
  Movement movement = Movement::kNone;
  /// For each of its components to be heard after a start; zero: it is not waited for.
  std::chrono::steady_clock::duration start_patience{};
  std::string log;
  bool goes_first = false;  ///< before all other programs of this machine, where that is permitted
  bool real_time = false;   ///< before those, too, where that is permitted

  State state = State::kWaiting;
  pid_t pid = 0;
  int starts = 0;
  std::string last_end;  ///< how it ended the last time, in words; empty before the first
  std::chrono::steady_clock::time_point start_at{};
  std::chrono::steady_clock::time_point kill_at{};  ///< while it is stopping
  std::chrono::steady_clock::time_point started_at{};
  std::deque<std::chrono::steady_clock::time_point> recent_starts;
  /// When its components were last heard, since this start; by name.
  std::map<std::string, std::chrono::steady_clock::time_point> heard_at;
  /// When the supervisor last heard them, by name.
  std::map<std::string, std::chrono::steady_clock::time_point> supervisor_heard_at;
};

/// Runs one host's part of a deployment as child processes: starts them in the manifest's order,
/// restarts the ones that end (the first time at once, then with growing pauses inside a budget),
/// stops them in order. Not thread-safe.
class Launcher {
 public:
  /// Writes the parameter files. Fails when the deployment has findings, the host is unknown, a
  /// program is missing, or this user already launched a part of this robot on this machine: the
  /// same host in the same DDS domain, or anything in the same run directory.
  static Result<Launcher> create(const Deployment& deployment, const LaunchOptions& options);
  /// Stops what still runs.
  ~Launcher();
  Launcher(Launcher&& other) noexcept;
  Launcher& operator=(Launcher&&) = delete;
  Launcher(const Launcher&) = delete;

  /// A component showed life. One that did once and then is silent for `kHang`, for the supervisor,
  /// too, hangs: it is killed, and its restart policy decides. A launcher that hears nobody at all
  /// knows nothing and kills nobody.
  void heard(const std::string& component, std::chrono::steady_clock::time_point at);
  static constexpr auto kHang = std::chrono::seconds(5);
  /// The supervisor hears a component, though it may not be heard here. One that the supervisor has
  /// not heard for `kHang`, and that was not heard here since its start for its start patience, is
  /// killed likewise.
  void heard_by_supervisor(const std::string& component, std::chrono::steady_clock::time_point at);

  /// Starts what is due, notices what ended. Call it at least ten times a second; never blocks.
  /// What happened since the last call is in events().
  void poll();
  /// Stops what asks for movement, waits until `stands` says that the robot stands (at most
  /// `kLongestStanding`; without it nobody waits), then stops the others in reverse order of their
  /// start, what holds the base last. Each gets SIGTERM, SIGKILL after two seconds; the next one's
  /// turn comes when it is gone, or is slow; that of the base when all others are gone. Blocks
  /// until all are.
  void stop(const std::function<bool()>& stands = {});
  static constexpr auto kLongestStanding = std::chrono::seconds(5);

  const std::vector<Process>& processes() const { return processes_; }
  const Process* find(const std::string& component) const;
  /// Sentences for an operator, in order; cleared by the call.
  std::vector<std::string> events();
  /// A process gave up without which the robot must not move (criticality stop).
  bool broken() const;
  /// A process gave up, whatever it means: the deployment is not what the manifest says.
  bool incomplete() const;
  /// Nothing has given up and nothing waits longer than it should for its start.
  bool healthy() const;
  /// "14 of 15 processes run: amcl is waiting"
  std::string summary() const;
  const std::string& run_directory() const { return options_.run_directory; }

 private:
  explicit Launcher(LaunchOptions options) : options_(std::move(options)) {}
  Status lock(const Deployment& deployment);
  Status prepare(const Deployment& deployment);
  Status forget_session() const;
  Status leave_operator_file(const Deployment& deployment, std::int64_t anchor);
  Status add_discovery_server(const Deployment& deployment, std::int64_t anchor);
  void ask_for_precedence();
  void start(Process& process);
  void ended(Process& process, int status);
  bool reap(Process& process);
  void kill_what_hangs();
  /// Empty when it does not.
  std::string hang_of(const Process& process, std::chrono::steady_clock::time_point now) const;
  void bound_logs();
  void watch_disk();
  void end(Process& process);
  void wait_until_gone(const std::function<bool(const Process&)>& which,
                       std::chrono::steady_clock::duration patience);

  LaunchOptions options_;
  std::vector<Process> processes_;
  std::vector<std::string> events_;
  std::string operator_file_;
  bool may_go_first_ = false;          ///< permitted
  bool may_run_in_real_time_ = false;  ///< permitted
  bool since_boot_ = false;            ///< this host's part was launched before, since the boot
  std::vector<int> locks_;             ///< open files, locked while this launcher lives
  std::chrono::steady_clock::time_point last_poll_{};
  std::chrono::steady_clock::time_point trusted_from_{};  ///< silence before is not believed
  std::chrono::steady_clock::time_point anybody_heard_at_{};
  std::chrono::steady_clock::time_point logs_bounded_{};
  bool disk_full_ = false;  ///< said
};

/// The file that a component gets with --parameters.
std::string to_yaml(const runtime::ParameterFile& file);

}  // namespace usher::operations
