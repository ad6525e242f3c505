// A navigator that is gone while the robot drives: nobody drives on along an old path, and the
// visit goes on when it is back.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "simulation/driving_robot.hpp"

namespace usher::operations {
namespace {

class NavigatorLoss : public DrivingRobot {
 protected:
  geometry::Point2 place() const { return run_->record().samples().back().truth.position(); }
  /// Until it neither speeds up nor slows down.
  void drive_steadily() {
    double before = 0.0;
    EXPECT_TRUE(becomes(
        [&] {
          run_->world().run_for(milliseconds(200));
          const double change = std::abs(speed() - std::exchange(before, speed()));
          return speed() > 0.3 && change < 0.05;
        },
        seconds(60)));
  }
  /// How far the robot gets until it stands; it has this long.
  double way_to_stand(milliseconds limit) {
    const auto from = place();
    const auto until = run_->world().now() + limit;
    while (run_->world().now() < until && std::abs(speed()) > 0.02)
      run_->world().run_for(milliseconds(20));
    EXPECT_LE(std::abs(speed()), 0.02) << "it should stand by now";
    return (place() - from).norm();
  }
  void goes_on_to_its_goal() {
    // Somebody may pass just then: it gives way for a while and creeps past.
    EXPECT_TRUE(becomes([&] { return speed() > 0.15; }, seconds(30))) << run_->complaints();
    EXPECT_TRUE(becomes(
        [&] {
          const auto& status = run_->record().navigation();
          return status &&
                 status->state() == usher_msgs::msg::GoalStatus_Constants::STATE_SUCCEEDED;
        },
        seconds(300)))
        << run_->complaints();
    EXPECT_EQ(run_->record().summary().contacts, 0U);
    EXPECT_EQ(faults_, 0);
  }
  /// What is noticed after 0.65 s and braked from the measured stopping distance.
  double allowed() const { return 0.65 * speed() + 1.48 * std::max(speed(), 0.3) + 0.1; }
};

TEST_F(NavigatorLoss, TheRobotStandsAndTheVisitGoesOnAfterItsRestart) {
  drive_steadily();
  const double bound = allowed();
  run_->world().stop("navigator");
  EXPECT_LE(way_to_stand(seconds(4)), bound);
  const auto stopped = place();
  run_->world().run_for(seconds(1));  // a balancing base sways back by some centimetres
  const auto stood = place();
  EXPECT_LT((stood - stopped).norm(), 0.15);
  run_->world().run_for(milliseconds(500));
  EXPECT_LT((place() - stood).norm(), 0.05);
  run_->world().start("navigator");
  goes_on_to_its_goal();
}

TEST_F(NavigatorLoss, TheRobotStandsAndGoesOnAfterItHung) {
  drive_steadily();
  const double bound = allowed();
  run_->world().hang("navigator", milliseconds(3500));
  EXPECT_LE(way_to_stand(seconds(3)), bound);
  goes_on_to_its_goal();
}

}  // namespace
}  // namespace usher::operations
