#include "deployment/running_robot.hpp"

#include <time.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "support/sanitizer.hpp"

namespace usher::test {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace usher_msgs::msg;

namespace {

/// A bound that is stretched further says nothing.
constexpr double kMostSlowdown = 5.0;

}  // namespace

bool is_well(const ComponentHealth& component) {
  return component.health() == SupervisorStatus_Constants::HEALTH_OK ||
         (component.name() == "world" &&
          component.health() == SupervisorStatus_Constants::HEALTH_DEGRADED);
}

std::string usher_program() { return std::string(USHER_BINARY_DIR) + "/bin/usher"; }

double slowdown() {
  const auto cpu = [] {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
  };
  const auto start = Clock::now();
  const double cpu_start = cpu();
  while (cpu() - cpu_start < 0.1) {
  }
  return std::clamp(Seconds(Clock::now() - start).count() / (cpu() - cpu_start), 1.0,
                    kMostSlowdown);
}

std::map<std::string, pid_t> components_from(const std::string& folder) {
  std::map<std::string, pid_t> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string pid = entry.path().filename();
    if (!std::all_of(pid.begin(), pid.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
      continue;
    std::istringstream words(content_of(entry.path() / "cmdline"));
    bool is_parameters = false;
    for (std::string word; std::getline(words, word, '\0');) {
      if (is_parameters && word.starts_with(folder + "/"))
        found[fs::path(word).stem()] = std::stoi(pid);
      is_parameters = word == "--parameters";
    }
  }
  return found;
}

std::set<std::string> shared_memory_of(const std::map<std::string, pid_t>& processes) {
  std::set<std::string> files;
  std::error_code error;
  for (const auto& [name, pid] : processes) {
    const fs::path process = "/proc/" + std::to_string(pid);
    std::istringstream maps(content_of(process / "maps"));
    for (std::string line; std::getline(maps, line);) {
      if (const auto at = line.find("/dev/shm/"); at != std::string::npos)
        files.insert(line.substr(at));
    }
    for (const auto& entry : fs::directory_iterator(process / "fd", error)) {
      const auto target = fs::read_symlink(entry.path(), error).string();
      if (target.starts_with("/dev/shm/")) files.insert(target);
    }
  }
  return files;
}

RunningRobot::RunningRobot(std::uint32_t domain, bool secure, const std::string& base,
                           const std::string& more)
    : domain_(domain) {
  ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1);
  ::setenv("XDG_STATE_HOME", folder_.path().c_str(), 1);
  manifest_ = folder_.file("deploy/robot.yaml",
                           "extends: " + std::string(USHER_SOURCE_DIR) + "/deploy/" + base +
                               "\ndomain: " + std::to_string(domain_) + "\n" + more);
  if (secure) {
    Process make({usher_program(), "keys", keys(), "--manifest", manifest_});
    const int code = make.wait();
    assert(code == 0);
    static_cast<void>(code);
  }
  auto observer =
      runtime::Observer::create({.name = "operator",
                                 .host = "nuc",
                                 .domain = domain_,
                                 .identity = secure ? keys() + "/operator" : std::string()});
  assert(observer);
  observer_ = std::move(observer).value();
  auto heartbeats = observer_->reader(
      topics::kHeartbeat, [this](const auto& message, const runtime::Observer::RawSample& sample) {
        {
          const std::lock_guard lock(mutex_);
          auto& life = lives_[message.component_name()];
          if (life.writer != sample.writer) life.at = Clock::now();
          life.writer = sample.writer;
          life.state = message.state();
          life.reason = message.reason();
        }
        heard_.notify_all();
      });
  assert(heartbeats);
  heartbeats_ = std::move(heartbeats).value();
  auto statuses =
      observer_->reader(topics::kSupervisorStatus, [this](const auto& message, const auto&) {
        {
          const std::lock_guard lock(mutex_);
          status_ = message;
          status_at_ = Clock::now();
          ++status_count_;
        }
        heard_.notify_all();
      });
  assert(statuses);
  statuses_ = std::move(statuses).value();
  launch();
}

RunningRobot::~RunningRobot() {
  launcher_->signal(SIGTERM);
  launcher_->wait(std::chrono::seconds(10));
}

void RunningRobot::launch(const std::vector<std::string>& before,
                          const std::vector<std::string>& after) {
  {
    const std::lock_guard lock(mutex_);
    status_.reset();
    lives_.clear();
  }
  std::vector<std::string> words = before;
  words.insert(words.end(), {usher_program(), "launch", manifest_});
  words.insert(words.end(), after.begin(), after.end());
  launcher_ = std::make_unique<Process>(std::move(words));
}

std::unique_ptr<Process> RunningRobot::command(std::vector<std::string> words,
                                               const std::string& terminal) const {
  words.insert(words.begin(), usher_program());
  words.push_back("--domain");
  words.push_back(std::to_string(domain_));
  return std::make_unique<Process>(std::move(words), terminal);
}

std::optional<SupervisorStatus> RunningRobot::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

bool RunningRobot::hears_supervisor() const {
  const std::lock_guard lock(mutex_);
  return status_ && Clock::now() - status_at_ < std::chrono::seconds(1);
}

std::size_t RunningRobot::status_count() const {
  const std::lock_guard lock(mutex_);
  return status_count_;
}

std::map<std::string, RunningRobot::Life> RunningRobot::lives() const {
  const std::lock_guard lock(mutex_);
  return lives_;
}

bool RunningRobot::may_drive() const {
  const std::lock_guard lock(mutex_);
  return status_ && Clock::now() - status_at_ < std::chrono::seconds(1) && status_->granted() &&
         std::all_of(status_->components().begin(), status_->components().end(), is_well);
}

std::string RunningRobot::complaints() const {
  const auto now = status();
  if (!now) return "no word from the supervisor\n" + launcher_->output() + launcher_->errors();
  std::string text = now->granted() ? "granted\n" : "not granted: " + now->reason() + "\n";
  for (const auto& component : now->components()) {
    if (!is_well(component))
      text += component.name() + ": " + std::to_string(component.health()) + " " +
              component.reason() + "\n";
  }
  for (const auto& fault : now->faults()) {
    if (fault.active()) text += "fault of " + fault.component_name() + ": " + fault.cause() + "\n";
  }
  return text;
}

std::string RunningRobot::fault_story() const {
  const auto now = status();
  std::string text;
  if (!now) return text;
  for (const auto& fault : now->faults())
    text += fault.component_name() + ": " + fault.cause() + (fault.active() ? "\n" : " (over)\n");
  return text;
}

bool RunningRobot::wait_for(const std::function<bool()>& condition, Seconds limit) const {
  const auto deadline =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(limit * kSanitizerFactor);
  while (!condition()) {
    if (Clock::now() >= deadline) return false;
    std::unique_lock lock(mutex_);
    heard_.wait_for(lock, std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace usher::test
