#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"

namespace usher::operations {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// The robot of the demo, on its way to the lounge, with its heartbeats counted.
class DrivingRobot : public testing::Test {
 protected:
  void SetUp() override {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    const auto deployment = load_deployment(share + "/deploy/demo.yaml", installation, {});
    ASSERT_TRUE(deployment.ok()) << deployment.error();
    auto run = LockstepRun::create(*deployment, 1);
    ASSERT_TRUE(run.ok()) << run.error();
    run_ = std::move(run).value();
    run_->world().observe(topics::kHeartbeat, [this](const auto& heartbeat, const auto&) {
      faults_ += heartbeat.state() == usher_msgs::msg::Heartbeat_Constants::STATE_FAULT;
      for (const auto& counter : heartbeat.counters())
        counters_[heartbeat.component_name()][counter.name()] = counter.count();
    });
    // The dialogue takes its time; then it shall be on its way for a while.
    const auto driving = [this] { return !run_->record().samples().empty() && speed() > 0.3; };
    while (run_->world().elapsed() < seconds(90) && !driving())
      run_->world().run_for(milliseconds(500));
    run_->world().run_for(seconds(1));
    ASSERT_GT(speed(), 0.3) << "it should be on its way";
  }

  double speed() const { return run_->record().samples().back().v; }
  std::uint64_t count(const std::string& component, const std::string& counter) {
    return counters_[component][counter];
  }
  bool becomes(const std::function<bool()>& condition, seconds limit) {
    const auto until = run_->world().now() + limit;
    for (; run_->world().now() < until; run_->world().run_for(milliseconds(100))) {
      if (condition()) return true;
    }
    return condition();
  }
  /// Calls `write` again and again for so long.
  void flood(seconds duration, const std::function<void()>& write,
             milliseconds period = milliseconds(20)) {
    for (auto t = milliseconds(0); t < duration; t += period) {
      write();
      run_->world().run_for(period);
    }
  }

  std::unique_ptr<LockstepRun> run_;
  std::map<std::string, std::map<std::string, std::uint64_t>> counters_;
  int faults_ = 0;
};

}  // namespace usher::operations
