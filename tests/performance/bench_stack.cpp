// `usher bench stack`: the whole simulated robot. As separate processes: how long it takes from a
// laser scan to the command that it leads to, and what all components cost. In lock-step: how much
// faster than the clock.
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "operations/launcher/launcher.hpp"
#include "operations/launcher/precedence.hpp"
#include "operations/launcher/run_places.hpp"
#include "runtime/dds/observer.hpp"
#include "support/bench.hpp"
#include "support/test_domain.hpp"
#include "wire/conversions.hpp"

namespace usher {
namespace {

using bench::Bench;
using bench::Bound;
using operations::Deployment;
using operations::Installation;
using operations::Launcher;
using operations::LockstepRun;
using runtime::Observer;
using runtime::Time;
using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr const char* kSimulator = "world";
constexpr const char* kDestination = "lounge";  // the way there takes longer than the measurement
constexpr auto kStartPatience = seconds(60);
constexpr auto kMeasured = seconds(30);
constexpr auto kWarmUp = seconds(2);
constexpr double kDriving = 0.2;  // [m/s]
constexpr auto kLockstep = seconds(60);
constexpr std::size_t kFewest = 200;  // commands without which percentiles mean little
/// This program may hear a command a little later than movement_control, which answers at once.
constexpr auto kHeardLater = std::chrono::microseconds(500);

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double processor_time() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// [s] of processor time that a process has used; 0 when it is gone.
double processor_time(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto name_end = text.rfind(')');
  if (name_end == std::string::npos) return 0.0;
  std::istringstream fields(text.substr(name_end + 1));
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;  // the state is field 3, utime field 14
  double user = 0.0, system = 0.0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double percentile(std::vector<double> values, double share) {
  if (values.size() < kFewest) return kNothing;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Follows scans through the robot: a scan arrives on `scan`; a wanted velocity carries the stamp
/// of the newest scan behind it; the first drive command written once movement_control had it is
/// the end.
class ScanToCommand {
 public:
  void scan(const sensor_msgs::msg::LaserScan& scan, Time arrival) {
    const std::lock_guard lock(mutex_);
    scans_[wire::from_message(scan.header().stamp())] = arrival;
    if (scans_.size() > kKept) scans_.erase(scans_.begin());
  }
  void velocity(const geometry_msgs::msg::TwistStamped& wanted, Time arrival) {
    const std::lock_guard lock(mutex_);
    if (!measuring_) return;
    const auto scan = scans_.find(wire::from_message(wanted.header().stamp()));
    if (scan == scans_.end()) {
      ++unknown_;
      return;
    }
    waiting_.push_back({scan->second, arrival - kHeardLater});
    settle();
  }
  void command(const usher_msgs::msg::DriveCommand& command) {
    const std::lock_guard lock(mutex_);
    commands_.push_back(wire::from_message(command.stamp()));
    if (commands_.size() > kKept) commands_.pop_front();
    settle();
  }
  void measure(bool on) {
    const std::lock_guard lock(mutex_);
    measuring_ = on;
  }
  /// [ms], and of velocities whose scan was not heard.
  std::vector<double> latencies() const {
    const std::lock_guard lock(mutex_);
    return latencies_;
  }
  std::size_t unknown() const {
    const std::lock_guard lock(mutex_);
    return unknown_;
  }

 private:
  static constexpr std::size_t kKept = 256;
  struct Waiting {
    Time scan_arrival;
    Time not_before;  ///< of the command
  };

  void settle() {
    std::erase_if(waiting_, [this](const Waiting& waiting) {
      const auto command = std::find_if(commands_.begin(), commands_.end(),
                                        [&](Time stamp) { return stamp >= waiting.not_before; });
      if (command == commands_.end()) return false;
      latencies_.push_back(1e3 * runtime::seconds(*command - waiting.scan_arrival));
      return true;
    });
  }

  mutable std::mutex mutex_;
  bool measuring_ = false;
  std::map<Time, Time> scans_;  ///< arrival by stamp
  std::deque<Time> commands_;   ///< stamps
  std::vector<Waiting> waiting_;
  std::vector<double> latencies_;
  std::size_t unknown_ = 0;
};

constexpr const char* kDemo = "demo.yaml";
constexpr const char* kPixels = "demo-pixels.yaml";

Result<Deployment> demo(const char* name, std::uint32_t domain) {
  const auto installation = Installation::of_this_program();
  const std::string manifest =
      std::filesystem::weakly_canonical(installation.share + "/deploy/" + name).string();
  auto deployment = operations::load_deployment(manifest, installation,
                                                {{"visitor", "destination", kDestination}});
  if (!deployment) return deployment;
  deployment->manifest.domain = domain;
  for (auto& file : deployment->files) file.domain = domain;
  return deployment;
}

/// What it heard late it would measure as late.
Result<std::unique_ptr<Observer>> observe(std::uint32_t domain) {
  return operations::made_before_all(
      [&] { return Observer::create({.name = "judge", .host = "nuc", .domain = domain}); });
}

/// Everything about the processes, measured once.
struct Processes {
  double p50 = kNothing, p99 = kNothing, worst = kNothing;  ///< [ms]
  double commands = 0.0, unknown_scans = 0.0;
  double cpu_percent = kNothing, simulator_cpu_percent = kNothing;
  double worst_lag = kNothing;  ///< [s] of the simulation
};

class Measurement {
 public:
  explicit Measurement(const char* manifest) : manifest_(manifest) {}
  const Processes& processes() {
    if (!measured_) {
      measured_ = true;
      if (const auto status = measure(); !status)
        std::fprintf(stderr, "bench stack: %s\n", status.error().c_str());
    }
    return processes_;
  }

 private:
  Status measure() {
    const std::uint32_t domain = test_domain();
    const auto deployment = demo(manifest_, domain);
    if (!deployment) return Error{deployment.error()};
    auto launcher = Launcher::create(*deployment, {"", Installation::of_this_program().programs,
                                                   operations::default_run_directory(domain, "")});
    if (!launcher) return Error{launcher.error()};
    ScanToCommand follow;
    std::atomic<double> speed{0.0}, lag{0.0};
    auto observer = observe(domain);
    if (!observer) return Error{observer.error()};
    const auto truth =
        (*observer)->reader(topics::kSimGroundTruth, [&](const auto& m, const auto&) {
          speed = m.v();
          lag = std::max(lag.load(), m.lag());
        });
    const auto scans = (*observer)->reader(
        topics::kScan, [&](const auto& m, const auto& sample) { follow.scan(m, sample.arrival); });
    const auto wanted = (*observer)->reader(
        topics::kCmdVelNavigation,
        [&](const auto& m, const auto& sample) { follow.velocity(m, sample.arrival); });
    const auto commands = (*observer)->reader(
        topics::kDriveCommand, [&](const auto& m, const auto&) { follow.command(m); });
    for (const auto* status :
         {truth.ok() ? nullptr : &truth.error(), scans.ok() ? nullptr : &scans.error(),
          wanted.ok() ? nullptr : &wanted.error(), commands.ok() ? nullptr : &commands.error()}) {
      if (status != nullptr) return Error{*status};
    }

    const auto run_until = [&](auto condition, auto patience) {
      const auto until = steady_clock::now() + patience;
      while (!condition() && !launcher->incomplete() && steady_clock::now() < until) {
        launcher->poll();
        std::this_thread::sleep_for(milliseconds(20));
      }
      return condition() && !launcher->incomplete();
    };
    std::fprintf(stderr, "starts %zu processes in domain %u\n",
                 deployment->manifest.components.size(), domain);
    if (!run_until([&] { return speed > kDriving; }, kStartPatience))
      return Error{"the robot does not drive; the logs are in " + launcher->run_directory()};
    const auto never = [] { return false; };
    run_until(never, kWarmUp);
    const auto before = processor_times(*launcher);
    const auto start = steady_clock::now();
    follow.measure(true);
    run_until(never, kMeasured);
    follow.measure(false);
    const double wall = std::chrono::duration<double>(steady_clock::now() - start).count();
    const auto after = processor_times(*launcher);
    const auto starts = restarts(*launcher);
    launcher->stop();
    if (starts > 0) return Error{std::to_string(starts) + " restarts while it was measured"};

    processes_.cpu_percent = processes_.simulator_cpu_percent = 0.0;
    for (const auto& [name, time] : after) {
      const double percent = 100.0 * (time - before.at(name)) / wall;
      (name == kSimulator ? processes_.simulator_cpu_percent : processes_.cpu_percent) += percent;
      std::fprintf(stderr, "  %-18s %5.1f %%\n", name.c_str(), percent);
    }
    const auto latencies = follow.latencies();
    processes_.commands = static_cast<double>(latencies.size());
    processes_.unknown_scans = static_cast<double>(follow.unknown());
    processes_.p50 = percentile(latencies, 0.50);
    processes_.p99 = percentile(latencies, 0.99);
    processes_.worst = percentile(latencies, 1.0);
    processes_.worst_lag = lag;
    return {};
  }

  static std::map<std::string, double> processor_times(const Launcher& launcher) {
    std::map<std::string, double> times;
    for (const auto& process : launcher.processes())
      times[process.name] = processor_time(process.pid);
    return times;
  }
  static int restarts(const Launcher& launcher) {
    int count = 0;
    for (const auto& process : launcher.processes()) count += process.starts - 1;
    return count;
  }

  const char* manifest_;
  bool measured_ = false;
  Processes processes_;
};

/// Simulated seconds per second of one processor.
double lockstep_realtime_factor(const char* manifest) {
  const auto deployment = demo(manifest, 0);
  if (!deployment) return kNothing;
  const double start = processor_time();
  auto run = LockstepRun::create(*deployment, 1);
  if (!run) {
    std::fprintf(stderr, "bench stack: %s\n", run.error().c_str());
    return kNothing;
  }
  (*run)->world().run_for(kLockstep);
  const double factor = runtime::seconds(kLockstep) / (processor_time() - start);
  const auto summary = (*run)->record().summary();
  std::fprintf(stderr, "lock-step: %.1f m driven in %.0f s\n", summary.path, summary.seconds);
  return summary.path > 1.0 ? factor : kNothing;
}

int run(int argc, char** argv) {
  Bench bench(
      "stack",
      "the components of deploy/demo.yaml as processes, 30 s of driving; the same for 60 s in "
      "lock-step; both again with every pixel rendered (demo-pixels.yaml)");
  Measurement measurement(kDemo), pixels(kPixels);
  const auto of = [&](Measurement& which, const char* key, double Processes::*figure) {
    bench.metric(key, [&which, figure] { return which.processes().*figure; });
  };
  const auto of_processes = [&](const char* key, double Processes::*figure) {
    of(measurement, key, figure);
  };
  of_processes("scan_to_command_p50_ms", &Processes::p50);
  of_processes("scan_to_command_p99_ms", &Processes::p99);
  of_processes("scan_to_command_max_ms", &Processes::worst);
  of_processes("commands", &Processes::commands);
  of_processes("commands_of_unheard_scans", &Processes::unknown_scans);
  of_processes("cpu_percent", &Processes::cpu_percent);
  of_processes("simulator_cpu_percent", &Processes::simulator_cpu_percent);
  of_processes("simulation_lag_s", &Processes::worst_lag);
  bench.metric("lockstep_realtime_factor", [] { return lockstep_realtime_factor(kDemo); });
  of(pixels, "pixels_scan_to_command_p50_ms", &Processes::p50);
  of(pixels, "pixels_scan_to_command_p99_ms", &Processes::p99);
  of(pixels, "pixels_cpu_percent", &Processes::cpu_percent);
  of(pixels, "pixels_simulator_cpu_percent", &Processes::simulator_cpu_percent);
  of(pixels, "pixels_simulation_lag_s", &Processes::worst_lag);
  bench.metric("pixels_lockstep_realtime_factor", [] { return lockstep_realtime_factor(kPixels); });
  bench.target("scan_to_command_p50_ms", Bound::kAtMost, 4);
  bench.target("scan_to_command_p99_ms", Bound::kAtMost, 15);
  bench.target("cpu_percent", Bound::kAtMost, 90);
  bench.target("lockstep_realtime_factor", Bound::kAtLeast, 20);
  bench.target("pixels_scan_to_command_p99_ms", Bound::kAtMost, 15);
  bench.target("pixels_cpu_percent", Bound::kAtMost, 90);
  bench.target("pixels_simulator_cpu_percent", Bound::kAtMost, 60);
  bench.target("pixels_lockstep_realtime_factor", Bound::kAtLeast, 1.5);
  return bench.run(argc, argv);
}

}  // namespace
}  // namespace usher

int main(int argc, char** argv) { return usher::run(argc, argv); }
