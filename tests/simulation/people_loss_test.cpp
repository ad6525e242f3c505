// MARVIN's limits with a person ahead are those without one, since its local planner foresees
// people: without a people detector nobody foresees anybody, and it drives slower.
#include <gtest/gtest.h>

#include <algorithm>

#include "simulation/driving_robot.hpp"

namespace usher::operations {
namespace {

class PeopleLoss : public DrivingRobot {
 protected:
  void SetUp() override {
    DrivingRobot::SetUp();
    run_->world().observe(topics::kMovementStatus, [this](const auto& status, const auto&) {
      limit_ = status.velocity_current_linear_max();
    });
    run_->world().observe(topics::kSupervisorStatus, [this](const auto& status, const auto&) {
      factor_ = status.speed_factor();
    });
  }
  /// The highest limit within that time, and the fastest that it drove.
  void drive(seconds duration) {
    highest_ = fastest_ = 0.0;
    for (auto t = milliseconds(0); t < duration; t += milliseconds(100)) {
      run_->world().run_for(milliseconds(100));
      highest_ = std::max(highest_, limit_);
      fastest_ = std::max(fastest_, speed());
    }
  }

  double limit_ = 0.0, factor_ = 1.0, highest_ = 0.0, fastest_ = 0.0;
};

TEST_F(PeopleLoss, MarvinDrivesSlowerUntilSomebodyLooksOutForPeopleAgain) {
  ASSERT_TRUE(becomes([&] { return limit_ > 0.8 && factor_ == 1.0; }, seconds(30)));
  run_->world().stop("people_detector");
  ASSERT_TRUE(becomes([&] { return factor_ == 0.5; }, seconds(2)));
  run_->world().run_for(seconds(2));  // to slow down
  drive(seconds(10));
  EXPECT_LE(highest_, 0.701) << "half of what is open";
  EXPECT_LE(fastest_, 0.75);
  EXPECT_GT(fastest_, 0.2) << "it goes on";
  run_->world().start("people_detector");
  EXPECT_TRUE(becomes([&] { return limit_ > 0.8 && factor_ == 1.0; }, seconds(30)));
  EXPECT_EQ(faults_, 0);
}

}  // namespace
}  // namespace usher::operations
