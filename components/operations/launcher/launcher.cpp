#include "operations/launcher/launcher.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "operations/launcher/precedence.hpp"
#include "operations/launcher/run_places.hpp"

namespace usher::operations {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr auto kBudgetWindow = seconds(60);
constexpr auto kShortestPause = milliseconds(100);
constexpr auto kLongestPause = seconds(5);
constexpr auto kGrace = seconds(2);
/// Authentications of all with all take half a minute on two cores, and begin anew with who does.
constexpr double kPatienceWithKeys = 2.0;
/// The next one's turn comes after this though the one before is not gone.
constexpr auto kTurn = milliseconds(250);
constexpr std::uintmax_t kLargestLog = 4'000'000;  // bytes; and one generation before
constexpr std::uintmax_t kLeastRoom = 100'000;     // bytes; less is a full disk
constexpr auto kLongestPollPause = milliseconds(500);
constexpr const char* kOperator = "operator";
constexpr const char* kDiscoveryServer = "discovery_server";
constexpr int kWrongParameters = 2;  // exit code of a component program

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

void write_addresses(const char* key, const std::vector<std::string>& all, std::ostream& out) {
  if (all.empty()) return;
  out << key << ": [";
  for (std::size_t i = 0; i < all.size(); ++i) out << (i > 0 ? ", " : "") << quoted(all[i]);
  out << "]\n";
}

/// The same for all components of this host, so that their stamps agree.
std::int64_t clock_anchor() {
  timespec wall{};
  timespec monotonic{};
  clock_gettime(CLOCK_REALTIME, &wall);
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return (wall.tv_sec - monotonic.tv_sec) * std::int64_t{1'000'000'000} +
         (wall.tv_nsec - monotonic.tv_nsec);
}

std::string words_for(int status) {
  if (WIFSIGNALED(status)) {
    const char* name = sigabbrev_np(WTERMSIG(status));
    return "killed by SIG" + (name != nullptr ? name : std::to_string(WTERMSIG(status)));
  }
  const int code = WEXITSTATUS(status);
  if (code == 0) return "ended by itself";
  if (code == kWrongParameters) return "refused its parameters";
  if (code == 3) return "ended with a fault";
  if (code == 127) return "could not be started";
  return "ended with code " + std::to_string(code);
}

/// The last lines of a log, to say why something ended.
std::string tail(const std::string& path, std::size_t bytes) {
  std::ifstream file(path, std::ios::ate | std::ios::binary);
  if (!file) return {};
  const auto size = static_cast<std::size_t>(file.tellg());
  file.seekg(static_cast<std::streamoff>(size > bytes ? size - bytes : 0));
  std::string text(std::istreambuf_iterator<char>(file), {});
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const auto line = text.rfind('\n');
  return line == std::string::npos ? text : text.substr(line + 1);
}

Status write_parameters(const runtime::ParameterFile& file, const std::string& path) {
  std::ofstream out(path, std::ios::trunc);
  out << to_yaml(file);
  out.close();
  if (!out) return Error{"cannot write " + path};
  return {};
}

}  // namespace

std::string to_yaml(const runtime::ParameterFile& file) {
  std::ostringstream out;
  out << "component: " << file.component << "\nname: " << file.name << "\nhost: " << file.host
      << "\ndomain: " << file.domain << "\nseed: " << file.seed
      << "\ncritical: " << (file.critical ? "true" : "false")
      << "\nclock_anchor: " << file.clock_anchor << "\n";
  if (!file.run_directory.empty()) out << "run_directory: " << quoted(file.run_directory) << "\n";
  write_addresses("peers", file.peers, out);
  if (!file.discovery_server.empty()) out << "discovery_server: " << file.discovery_server << "\n";
  if (!file.identity.empty()) out << "identity: " << quoted(file.identity) << "\n";
  if (!file.robot.empty()) {
    out << "robot: " << file.robot << "\nfleet_domain: " << file.fleet_domain << "\n";
    write_addresses("fleet_peers", file.fleet_peers, out);
  }
  out << (file.values.empty() ? "parameters: {}\n" : "parameters:\n");
  for (const auto& value : file.values) {
    out << "  " << value.name << ": {value: " << value.yaml << ", origin: " << quoted(value.origin)
        << "}\n";
  }
  return out.str();
}

Result<Launcher> Launcher::create(const Deployment& deployment, const LaunchOptions& options) {
  if (!deployment.findings.empty()) return Error{to_string(deployment.findings.front())};
  if (!options.host.empty() && deployment.manifest.host(options.host) == nullptr) {
    std::string known;
    for (const auto& host : deployment.manifest.hosts)
      known += (known.empty() ? "" : ", ") + host.name;
    return Error{"unknown host '" + options.host + "', expected one of " + known + " (" +
                 deployment.manifest.path + ")"};
  }
  Launcher launcher(options);
  if (auto status = launcher.lock(deployment); !status) return Error{status.error()};
  if (auto status = launcher.prepare(deployment); !status) return Error{status.error()};
  return launcher;
}

Launcher::Launcher(Launcher&& other) noexcept
    : options_(std::move(other.options_)),
      processes_(std::move(other.processes_)),
      events_(std::move(other.events_)),
      operator_file_(std::exchange(other.operator_file_, {})),
      may_go_first_(other.may_go_first_),
      may_run_in_real_time_(other.may_run_in_real_time_),
      since_boot_(other.since_boot_),
      locks_(std::exchange(other.locks_, {})),
      last_poll_(other.last_poll_),
      trusted_from_(other.trusted_from_) {
  other.processes_.clear();
}

Launcher::~Launcher() {
  stop();
  if (!operator_file_.empty()) unlink(operator_file_.c_str());
  for (const int file : locks_) close(file);
}

Status Launcher::lock(const Deployment& deployment) {
  if (auto status = make_lock_directory(); !status) return status;
  std::error_code error;
  // Memories of visitors and the paths of keys are of nobody else's concern.
  if (std::filesystem::create_directories(options_.run_directory, error))
    std::filesystem::permissions(options_.run_directory, std::filesystem::perms::owner_all, error);
  if (error) return Error{"cannot write " + options_.run_directory + ": " + error.message()};
  std::vector<std::string> paths{options_.run_directory + "/lock"};
  for (const auto& host : deployment.manifest.hosts) {
    if (!options_.host.empty() && host.name != options_.host) continue;
    paths.push_back(launcher_lock(deployment.manifest.domain, host.name));
    since_boot_ = since_boot_ || written_since_boot(paths.back());
  }
  for (const std::string& path : paths) {
    const auto held = take_lock(path);
    if (!held) return Error{held.error()};
    locks_.push_back(*held);
  }
  return {};
}

/// Wherever the run directory lies: after a boot the robot may stand elsewhere, and its visitor has
/// gone.
Status Launcher::forget_session() const {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path kept = options_.run_directory + "/kept";
  if (!fs::exists(kept, error)) return {};
  std::vector<fs::path> forgotten;
  for (fs::recursive_directory_iterator at(kept, error), end; !error && at != end;
       at.increment(error)) {
    if (at->path().filename().string().starts_with("session.")) forgotten.push_back(at->path());
  }
  for (const auto& path : forgotten) {
    if (!error) fs::remove(path, error);
  }
  if (error) return Error{"cannot empty " + kept.string() + ": " + error.message()};
  return {};
}

Status Launcher::prepare(const Deployment& deployment) {
  if (deployment.manifest.fresh_start) {
    std::error_code error;
    std::filesystem::remove_all(options_.run_directory + "/kept", error);
    if (error) return Error{"cannot empty " + options_.run_directory + "/kept: " + error.message()};
  }
  if (!since_boot_) {
    if (auto status = forget_session(); !status) return status;
  }
  const std::int64_t anchor = clock_anchor();
  if (auto status = leave_operator_file(deployment, anchor); !status) return status;
  if (auto status = add_discovery_server(deployment, anchor); !status) return status;
  for (std::size_t i = 0; i < deployment.files.size(); ++i) {
    const auto& component = deployment.manifest.components[i];
    if (!options_.host.empty() && component.host != options_.host) continue;
    auto file = deployment.files[i];
    file.clock_anchor = anchor;
    file.run_directory = options_.run_directory;
    const std::string path = options_.run_directory + "/" + component.name + ".yaml";
    if (auto status = write_parameters(file, path); !status) return status;

    const bool grouped = !component.group.empty();
    const std::string name = grouped ? component.group : component.name;
    auto process = std::find_if(processes_.begin(), processes_.end(),
                                [&](const Process& p) { return p.name == name; });
    if (process == processes_.end()) {
      const std::string program =
          options_.program_directory + "/usher-" + (grouped ? "group" : component.type);
      if (access(program.c_str(), X_OK) != 0)
        return Error{"program " + program + " is missing (" + component.origin + ")"};
      process = processes_.emplace(processes_.end());
      process->name = name;
      process->arguments = {program};
      process->restart = component.restart;
      process->budget = component.restart_budget;
      process->log = options_.run_directory + "/" + name + ".log";
      std::error_code ignored;  // the former launch's, one generation
      std::filesystem::rename(process->log, process->log + ".1", ignored);
    }
    process->criticality = std::min(process->criticality, component.criticality);
    const std::chrono::duration<double> patience(
        component.start_patience * (deployment.manifest.keys.empty() ? 1.0 : kPatienceWithKeys));
    process->start_patience =
        std::max(process->start_patience, std::chrono::duration_cast<Clock::duration>(patience));
    if (const auto found = deployment.movement.find(component.name);
        found != deployment.movement.end())
      process->movement = std::max(process->movement, found->second);
    process->goes_first = process->goes_first || file.critical;
    process->real_time = process->real_time || component.real_time;
    process->components.push_back(component.name);
    process->arguments.push_back("--parameters");
    process->arguments.push_back(path);
  }
  if (processes_.empty())
    return Error{"nothing runs on host '" + options_.host + "' (" + deployment.manifest.path + ")"};
  ask_for_precedence();
  return {};
}

void Launcher::ask_for_precedence() {
  may_go_first_ = may_go_first();
  may_run_in_real_time_ = may_run_in_real_time();
  if (!may_go_first_) {
    events_.push_back(
        "the drive chain cannot go before other programs here, so a busy machine may stop the "
        "robot (permit it with CAP_SYS_NICE or RLIMIT_NICE 31)");
  }
  if (may_run_in_real_time_) return;
  for (const Process& process : processes_) {
    if (!process.real_time) continue;
    events_.push_back(process.name +
                      ": cannot run in real time here, so it is less even than its manifest wants "
                      "(that takes two processors, and CAP_SYS_NICE or RLIMIT_RTPRIO " +
                      std::to_string(kRealTime) + ")");
  }
}

Status Launcher::leave_operator_file(const Deployment& deployment, std::int64_t anchor) {
  const Manifest& manifest = deployment.manifest;
  runtime::ParameterFile file;
  file.component = file.name = kOperator;
  file.host = options_.host.empty() ? manifest.hosts.front().name : options_.host;
  file.domain = manifest.domain;
  file.clock_anchor = anchor;
  if (const auto* host = manifest.host(file.host)) file.peers = host->peers;
  file.discovery_server = manifest.discovery_server.locator();
  if (!manifest.keys.empty()) file.identity = manifest.keys + "/" + kOperator;
  operator_file_ = operator_files(manifest.domain).front();
  return write_parameters(file, operator_file_);
}

Status Launcher::add_discovery_server(const Deployment& deployment, std::int64_t anchor) {
  const auto& server = deployment.manifest.discovery_server;
  if (server.host.empty() || (!options_.host.empty() && server.host != options_.host)) return {};
  runtime::ParameterFile file;
  file.component = file.name = kDiscoveryServer;
  file.host = server.host;
  file.domain = deployment.manifest.domain;
  file.clock_anchor = anchor;
  file.discovery_server = server.locator();
  if (!deployment.manifest.keys.empty())
    file.identity = deployment.manifest.keys + "/" + kDiscoveryServer;
  const std::string path = options_.run_directory + "/" + kDiscoveryServer + ".yaml";
  if (auto status = write_parameters(file, path); !status) return status;
  Process& process = processes_.emplace_back();
  process.name = kDiscoveryServer;
  process.arguments = {options_.program_directory + "/usher-" + kDiscoveryServer, "--parameters",
                       path};
  process.components = {kDiscoveryServer};
  process.budget = 1000;  // nothing finds anything without it
  process.criticality = Criticality::kStop;
  process.goes_first = true;  // everybody waits for it
  process.log = options_.run_directory + "/" + kDiscoveryServer + ".log";
  return {};
}

void Launcher::start(Process& process) {
  std::vector<char*> arguments;
  for (auto& argument : process.arguments) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) {
    // Only async-signal-safe calls from here to execv. Nobody outlives the launcher.
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(127);
    setpgid(0, 0);  // a Ctrl-C at the terminal reaches the launcher alone, which stops in order
    const int log = open(process.log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    const int null = open("/dev/null", O_RDONLY);
    if (log >= 0) dup2(log, STDOUT_FILENO), dup2(log, STDERR_FILENO);
    if (null >= 0) dup2(null, STDIN_FILENO);
    if (process.goes_first && may_go_first_) go_first();
    if (process.real_time && may_run_in_real_time_) run_in_real_time();
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  if (pid < 0) {
    process.pid = 0;
    process.state = Process::State::kWaiting;
    process.start_at = Clock::now() + kLongestPause;
    events_.push_back(process.name + ": cannot start: " + std::strerror(errno));
    return;
  }
  process.pid = pid;
  process.state = Process::State::kRunning;
  ++process.starts;
  process.heard_at.clear();
  process.started_at = Clock::now();
  process.recent_starts.push_back(process.started_at);
  events_.push_back(process.name + (process.starts == 1 ? ": started" : ": started again"));
}

void Launcher::ended(Process& process, int status) {
  process.pid = 0;
  process.last_end = words_for(status);
  if (process.state == Process::State::kStopping) {
    process.state = Process::State::kStopped;
    return;
  }
  const bool clean = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  const bool hopeless =
      WIFEXITED(status) && (WEXITSTATUS(status) == kWrongParameters || WEXITSTATUS(status) == 127);
  const auto now = Clock::now();
  std::erase_if(process.recent_starts, [&](auto start) { return now - start > kBudgetWindow; });
  std::string event = process.name + ": " + process.last_end;
  if (const auto why = tail(process.log, 2000); !why.empty() && !clean) event += " (" + why + ")";
  if (hopeless || process.restart == RestartPolicy::kNever ||
      (clean && process.restart == RestartPolicy::kOnFailure)) {
    process.state = hopeless || !clean ? Process::State::kGaveUp : Process::State::kStopped;
  } else if (static_cast<int>(process.recent_starts.size()) > process.budget) {
    process.state = Process::State::kGaveUp;
    event += ", more than " + std::to_string(process.budget) + " starts within a minute: given up";
    if (process.criticality == Criticality::kNotify) event += "; the robot goes on without it";
  } else {
    // At once the first time; each further end within the window doubles the pause.
    const auto repeats = static_cast<int>(process.recent_starts.size()) - 1;
    const auto pause = repeats <= 0
                           ? Clock::duration::zero()
                           : std::min<Clock::duration>(
                                 kShortestPause * (1 << std::min(repeats - 1, 10)), kLongestPause);
    process.state = Process::State::kWaiting;
    process.start_at = now + pause;
  }
  events_.push_back(event);
}

bool Launcher::reap(Process& process) {
  if (process.pid == 0) return false;
  int status = 0;
  if (waitpid(process.pid, &status, WNOHANG) != process.pid) return false;
  ended(process, status);
  return true;
}

void Launcher::heard(const std::string& component, Clock::time_point at) {
  anybody_heard_at_ = std::max(anybody_heard_at_, at);
  for (auto& process : processes_) {
    if (process.state != Process::State::kRunning || at < process.started_at)
      continue;  // a word of its former life
    const auto& names = process.components;
    if (std::find(names.begin(), names.end(), component) != names.end())
      process.heard_at[component] = at;
  }
}

void Launcher::heard_by_supervisor(const std::string& component, Clock::time_point at) {
  for (auto& process : processes_) {
    const auto& names = process.components;
    if (std::find(names.begin(), names.end(), component) != names.end())
      process.supervisor_heard_at[component] = at;
  }
}

std::string Launcher::hang_of(const Process& process, Clock::time_point now) const {
  if (now - anybody_heard_at_ > kHang) return {};
  const auto supervisor_hears = [&](const std::string& component) {
    const auto at = process.supervisor_heard_at.find(component);
    return at != process.supervisor_heard_at.end() && now - at->second <= kHang;
  };
  for (const auto& [component, at] : process.heard_at) {
    if (now - at > kHang && !supervisor_hears(component)) return component + ": hangs, killed";
  }
  const auto patience = process.start_patience;
  if (patience == Clock::duration::zero() ||
      now - std::max(process.started_at, trusted_from_) <= patience)
    return {};
  for (const auto& component : process.components) {
    if (process.heard_at.contains(component) || supervisor_hears(component)) continue;
    std::ostringstream text;
    text << component << ": has not come alive within "
         << std::chrono::duration<double>(patience).count() << " s of its start, killed";
    return text.str();
  }
  return {};
}

void Launcher::kill_what_hangs() {
  const auto now = Clock::now();
  // A launcher that was stopped itself has heard nobody: that is no reason to kill anybody.
  if (now - last_poll_ > kLongestPollPause) trusted_from_ = now;
  last_poll_ = now;
  if (now - trusted_from_ <= kHang) return;
  for (auto& process : processes_) {
    if (process.state != Process::State::kRunning) continue;
    const std::string hang = hang_of(process, now);
    if (hang.empty()) continue;
    events_.push_back(hang);
    kill(process.pid, SIGKILL);
    process.heard_at.clear();
    process.started_at = now;  // it is said and done once
  }
}

void Launcher::poll() {
  for (auto& process : processes_) reap(process);
  kill_what_hangs();
  bound_logs();
  for (auto& process : processes_) {
    if (process.state == Process::State::kWaiting && Clock::now() >= process.start_at)
      start(process);
  }
}

/// A component writes at the end of its log, wherever that is: so it may be cut under its hands.
void Launcher::bound_logs() {
  const auto now = Clock::now();
  if (now - logs_bounded_ < seconds(1)) return;
  logs_bounded_ = now;
  for (const auto& process : processes_) {
    std::error_code error;
    if (std::filesystem::file_size(process.log, error) <= kLargestLog || error) continue;
    std::filesystem::copy_file(process.log, process.log + ".1",
                               std::filesystem::copy_options::overwrite_existing, error);
    std::filesystem::resize_file(process.log, 0, error);
  }
  watch_disk();
}

void Launcher::watch_disk() {
  std::error_code error;
  const auto room = std::filesystem::space(options_.run_directory, error).available;
  if (error || disk_full_ == (room < (disk_full_ ? 2 * kLeastRoom : kLeastRoom))) return;
  disk_full_ = !disk_full_;
  events_.push_back(disk_full_ ? "the disk is full: the robot goes on, but logs end, and a restart "
                                 "forgets what cannot be kept (" +
                                     options_.run_directory + ")"
                               : "the disk has room again");
}

void Launcher::end(Process& process) {
  if (process.pid == 0) {
    if (process.state == Process::State::kWaiting) process.state = Process::State::kStopped;
    return;
  }
  process.state = Process::State::kStopping;
  process.kill_at = Clock::now() + kGrace;
  kill(process.pid, SIGCONT);  // a stopped process would not hear the next one
  kill(process.pid, SIGTERM);
}

void Launcher::wait_until_gone(const std::function<bool(const Process&)>& which,
                               Clock::duration patience) {
  const auto until = Clock::now() + patience;
  const auto runs = [&](const Process& p) { return p.pid != 0 && which(p); };
  while (std::any_of(processes_.begin(), processes_.end(), runs) && Clock::now() < until) {
    for (auto& process : processes_) {
      if (reap(process) || process.state != Process::State::kStopping || process.pid == 0 ||
          Clock::now() < process.kill_at)
        continue;
      events_.push_back(process.name + ": did not stop within 2 s, killed");
      kill(process.pid, SIGKILL);
      process.kill_at = Clock::time_point::max();
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
}

void Launcher::stop(const std::function<bool()>& stands) {
  constexpr auto kForGood = std::chrono::hours(1);  // SIGKILL ends each long before
  const auto all = [](Movement movement) {
    return [movement](const Process& p) { return p.movement == movement; };
  };
  const auto in_reverse = [&](Movement movement) {
    for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
      if (process->movement != movement) continue;
      end(*process);
      wait_until_gone([&](const Process& p) { return &p == &*process; }, kTurn);
    }
  };
  const bool moves = std::any_of(processes_.begin(), processes_.end(), [](const Process& p) {
    return p.movement == Movement::kBaseDriver && p.state == Process::State::kRunning;
  });
  in_reverse(Movement::kCommands);
  if (stands && moves) {
    const auto until = Clock::now() + kLongestStanding;
    while (!stands() && Clock::now() < until) std::this_thread::sleep_for(milliseconds(5));
    if (Clock::now() >= until) events_.push_back("the robot was not seen to stand within 5 s");
  }
  in_reverse(Movement::kNone);
  wait_until_gone([](const Process& p) { return p.movement != Movement::kBaseDriver; }, kForGood);
  in_reverse(Movement::kBaseDriver);
  wait_until_gone(all(Movement::kBaseDriver), kForGood);
}

const Process* Launcher::find(const std::string& component) const {
  const auto found =
      std::find_if(processes_.begin(), processes_.end(), [&](const Process& process) {
        return std::find(process.components.begin(), process.components.end(), component) !=
               process.components.end();
      });
  return found == processes_.end() ? nullptr : &*found;
}

std::vector<std::string> Launcher::events() { return std::exchange(events_, {}); }

bool Launcher::healthy() const {
  const auto overdue = Clock::now() - seconds(1);
  return !broken() && std::none_of(processes_.begin(), processes_.end(), [&](const Process& p) {
    return p.state == Process::State::kWaiting && p.start_at != Clock::time_point{} &&
           p.start_at < overdue;
  });
}

std::string Launcher::summary() const {
  std::size_t running = 0;
  std::string others;
  for (const auto& process : processes_) {
    if (process.state == Process::State::kRunning) {
      ++running;
    } else {
      others += (others.empty() ? ": " : ", ") + process.name +
                (process.state == Process::State::kWaiting  ? " is waiting"
                 : process.state == Process::State::kGaveUp ? " is given up"
                                                            : " has stopped");
    }
  }
  return std::to_string(running) + " of " + std::to_string(processes_.size()) + " processes run" +
         others;
}

bool Launcher::broken() const {
  return std::any_of(processes_.begin(), processes_.end(), [](const Process& p) {
    return p.state == Process::State::kGaveUp && p.criticality == Criticality::kStop;
  });
}

bool Launcher::incomplete() const {
  return std::any_of(processes_.begin(), processes_.end(),
                     [](const Process& p) { return p.state == Process::State::kGaveUp; });
}

}  // namespace usher::operations
