// The people whom the robot with simulated depth cameras knows of, against those who are there.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::operations {
namespace {

using geometry::Point2;
using geometry::Pose2;

constexpr double kSame = 0.6;  // [m]

/// MARVIN in the foyer of the office, people walking about.
class PeopleOfTheRobot : public testing::Test {
 protected:
  void SetUp() override {
    const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
    const Installation installation{
        .programs = {}, .contracts = share + "/contracts", .share = share};
    const auto deployment = load_deployment(share + "/deploy/marvin-depth-sim.yaml", installation,
                                            {{"world", "people", "true"}});
    ASSERT_TRUE(deployment.ok()) << deployment.error();
    auto run = LockstepRun::create(*deployment, 3);
    ASSERT_TRUE(run.ok()) << run.error();
    run_ = std::move(run).value();
    run_->world().observe(topics::kSimGroundTruth,
                          [this](const auto& truth, const auto&) { truth_ = truth; });
    run_->world().observe(topics::kAmclPose, [this](const auto& pose, const auto&) {
      if (const auto planar = wire::to_planar(pose.pose().pose())) map_T_base_ = *planar;
    });
    run_->world().observe(topics::kOdom, [this](const auto& odom, const auto&) {
      if (const auto planar = wire::to_planar(odom.pose().pose())) odom_T_base_ = *planar;
    });
    run_->world().observe(topics::kPeople,
                          [this](const auto& people, const auto&) { judge(people); });
  }

  void judge(const usher_msgs::msg::People& people) {
    if (!truth_) return;
    const Pose2 map_T_odom = map_T_base_ * inverse(odom_T_base_);
    for (const auto& person : people.people()) {
      if (person.unseen() > 0.2F) continue;
      const Point2 place = map_T_odom * Point2(person.x(), person.y());
      bool real = false;
      for (const auto& other : truth_->people())
        real = real || (Point2(other.x(), other.y()) - place).norm() < kSame;
      ++(real ? real_ : nobody_);
      by_camera_ += person.by_kinect() || person.by_rear();
      by_both_ += (person.by_kinect() || person.by_rear()) && person.by_laser();
    }
  }

  std::unique_ptr<LockstepRun> run_;
  std::optional<usher_sim_msgs::msg::GroundTruth> truth_;
  Pose2 map_T_base_, odom_T_base_;
  int real_ = 0, nobody_ = 0, by_camera_ = 0, by_both_ = 0;
};

TEST_F(PeopleOfTheRobot, AreThoseWhoAreThereSeenByCamerasAndLaserTogether) {
  run_->world().run_for(std::chrono::seconds(120));
  std::printf("%d real, %d nobody, %d by a camera, %d by both\n", real_, nobody_, by_camera_,
              by_both_);
  EXPECT_GT(real_, 200);
  EXPECT_LT(nobody_, real_ / 50);
  EXPECT_GT(by_camera_, real_ / 10);
  EXPECT_GT(by_both_, by_camera_ / 3);
}

}  // namespace
}  // namespace usher::operations
