#include <chrono>
#include <mutex>
#include <thread>

#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/launcher/launcher.hpp"
#include "runtime/dds/observer.hpp"

namespace usher::operations {

namespace {

using runtime::Observer;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr auto kRepeat = milliseconds(200);
constexpr auto kPoll = milliseconds(20);
constexpr std::uint64_t kIdsPerErrand = 1000;

class ProcessRobot final : public CommandedRobot {
 public:
  static Result<std::unique_ptr<CommandedRobot>> create(const Deployment& deployment,
                                                        const Installation& installation,
                                                        const std::string& run_directory) {
    auto launcher = Launcher::create(deployment, {"", installation.programs, run_directory});
    if (!launcher) return Error{launcher.error()};
    std::unique_ptr<ProcessRobot> robot(new ProcessRobot(std::move(launcher).value()));
    if (auto status = robot->listen(deployment.manifest.domain); !status)
      return Error{status.error()};
    return std::unique_ptr<CommandedRobot>(std::move(robot));
  }

  Result<Arrival> send(const std::string& location, double longest) override {
    Errand errand(location, next_id_,
                  {[&](const auto& request) { request_->write(request); },
                   [&](const auto& goal) { goal_->write(goal); }});
    next_id_ += kIdsPerErrand;
    const auto set = [this](Errand* current) {
      const std::lock_guard lock(mutex_);
      errand_ = current;
    };
    set(&errand);
    const auto until = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                                 std::chrono::duration<double>(longest));
    auto next_step = steady_clock::now();
    bool over = false;
    while (!over && !launcher_.incomplete() && steady_clock::now() < until) {
      launcher_.poll();
      {
        const std::lock_guard lock(mutex_);
        if (steady_clock::now() >= next_step) {
          errand.step();
          next_step += kRepeat;
        }
        over = errand.over();
      }
      std::this_thread::sleep_for(kPoll);
    }
    set(nullptr);
    if (launcher_.incomplete())
      return Error{"a component cannot be kept running; its log is in " +
                   launcher_.run_directory()};
    return arrival(errand, longest);
  }

  RunRecord take_record() override {
    const std::lock_guard lock(mutex_);
    return std::exchange(record_, {});
  }
  double elapsed() const override {
    return std::chrono::duration<double>(steady_clock::now() - start_).count();
  }

 private:
  explicit ProcessRobot(Launcher launcher) : launcher_(std::move(launcher)) {}

  Status listen(std::uint32_t domain) {
    auto observer = Observer::create({.name = Errand::kClient, .host = "nuc", .domain = domain});
    if (!observer) return Error{observer.error()};
    observer_ = std::move(observer).value();
    const auto note = [this](const auto& message, const auto&) {
      const std::lock_guard lock(mutex_);
      record_.take(message);
    };
    Status status;
    const auto keep = [&](auto made, auto& reader) {
      if (made) {
        reader = std::move(made).value();
      } else {
        status = Error{made.error()};
      }
    };
    keep(observer_->reader(topics::kSimGroundTruth, note), truth_);
    keep(observer_->reader(topics::kAmclPose, note), pose_);
    keep(observer_->reader(topics::kPlan, note), plan_);
    keep(observer_->reader(topics::kNavigateStatus,
                           [this](const auto& message, const auto&) {
                             const std::lock_guard lock(mutex_);
                             record_.take(message);
                             if (errand_ != nullptr) errand_->take(message);
                           }),
         navigation_);
    keep(observer_->reader(topics::kSupervisorStatus,
                           [this](const auto& message, const auto&) {
                             const std::lock_guard lock(mutex_);
                             if (errand_ != nullptr) errand_->take(message);
                           }),
         supervisor_);
    keep(observer_->writer(topics::kSupervisorRequest), request_);
    keep(observer_->writer(topics::kNavigateGoal), goal_);
    return status;
  }

  // Last to be destroyed first: no callback after the record is gone.
  Launcher launcher_;
  const steady_clock::time_point start_ = steady_clock::now();
  std::mutex mutex_;
  RunRecord record_;
  Errand* errand_ = nullptr;
  std::uint64_t next_id_ = kIdsPerErrand;
  std::unique_ptr<Observer> observer_;
  std::optional<Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truth_;
  std::optional<Observer::Reader<geometry_msgs::msg::PoseWithCovarianceStamped>> pose_;
  std::optional<Observer::Reader<nav_msgs::msg::Path>> plan_;
  std::optional<Observer::Reader<usher_msgs::msg::NavigateStatus>> navigation_;
  std::optional<Observer::Reader<usher_msgs::msg::SupervisorStatus>> supervisor_;
  std::optional<Observer::Writer<usher_msgs::msg::SupervisorRequest>> request_;
  std::optional<Observer::Writer<usher_msgs::msg::NavigateGoal>> goal_;
};

}  // namespace

Result<std::unique_ptr<CommandedRobot>> process_robot(Deployment deployment, std::uint64_t seed,
                                                      const Installation& installation,
                                                      std::uint32_t domain,
                                                      const std::string& run_directory) {
  deployment.manifest.domain = domain;
  for (auto& file : deployment.files) {
    file.seed = seed;
    file.domain = domain;
  }
  return ProcessRobot::create(deployment, installation, run_directory);
}

}  // namespace usher::operations
