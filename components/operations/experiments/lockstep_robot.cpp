#include <time.h>

#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/errand.hpp"
#include "operations/experiments/lockstep_run.hpp"

namespace usher::operations {

namespace {

using std::chrono::milliseconds;

constexpr auto kRepeat = milliseconds(200);
constexpr std::uint64_t kIdsPerErrand = 1000;

double thread_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class LockstepRobot final : public CommandedRobot {
 public:
  LockstepRobot(std::unique_ptr<LockstepRun> run, double started)
      : run_(std::move(run)), started_(started) {
    const auto take = [this](const auto& message, const auto&) {
      if (errand_ != nullptr) errand_->take(message);
    };
    run_->world().observe(topics::kSupervisorStatus, take);
    run_->world().observe(topics::kNavigateStatus, take);
  }

  Result<Arrival> send(const std::string& location, double longest) override {
    auto& world = run_->world();
    Errand errand(
        location, next_id_,
        {[&](const auto& request) {
           world.publish(topics::kSupervisorRequest, request, Errand::kClient);
         },
         [&](const auto& goal) { world.publish(topics::kNavigateGoal, goal, Errand::kClient); }});
    next_id_ += kIdsPerErrand;
    errand_ = &errand;
    const auto until = world.now() + runtime::from_seconds(longest);
    while (!errand.over() && world.now() < until) {
      errand.step();
      world.run_for(kRepeat);
    }
    errand_ = nullptr;
    return arrival(errand, longest);
  }

  RunRecord take_record() override {
    RunRecord record = run_->record();
    run_->restart_record();
    return record;
  }
  std::string complaints() const override { return run_->complaints(); }
  double elapsed() const override { return runtime::seconds(run_->world().elapsed()); }
  double processor_time() const override { return thread_time() - started_; }

 private:
  std::unique_ptr<LockstepRun> run_;
  double started_;
  Errand* errand_ = nullptr;
  std::uint64_t next_id_ = kIdsPerErrand;
};

}  // namespace

Result<std::unique_ptr<CommandedRobot>> lockstep_robot(
    const Deployment& deployment, std::uint64_t seed,
    const std::function<void(LockstepRun&)>& watch) {
  const double started = thread_time();
  auto run = LockstepRun::create(deployment, seed);
  if (!run) return Error{run.error()};
  if (watch) watch(**run);
  return std::unique_ptr<CommandedRobot>(
      std::make_unique<LockstepRobot>(std::move(run).value(), started));
}

}  // namespace usher::operations
