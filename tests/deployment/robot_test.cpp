// The whole simulated robot as processes: it starts, survives the death of its parts, ends.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "deployment/running_robot.hpp"

namespace usher::test {
namespace {

using usher_msgs::msg::Heartbeat_Constants::STATE_OK;

class Robot : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    slow_before_ = slowdown();
    launched_ = std::chrono::steady_clock::now();
    robot_ = new RunningRobot;
  }
  static void TearDownTestSuite() {
    delete robot_;
    robot_ = nullptr;
  }
  static bool booted() {
    return robot_->wait_for([] { return robot_->may_drive(); }, Seconds(60));
  }
  static RunningRobot* robot_;
  static double slow_before_;
  static std::chrono::steady_clock::time_point launched_;
};
RunningRobot* Robot::robot_ = nullptr;
double Robot::slow_before_ = 1.0;
std::chrono::steady_clock::time_point Robot::launched_;

TEST_F(Robot, IsWellWithin15Seconds) {
  const bool well =
      robot_->wait_for([] { return robot_->may_drive(); }, Seconds(15.0 * slow_before_));
  const Seconds took = std::chrono::steady_clock::now() - launched_;
  std::printf("every component is ok and the robot may drive after %.1f s (machine %.1fx)\n",
              took.count(), slow_before_);
  ASSERT_TRUE(well) << robot_->complaints();
  // The supervisor does not watch itself.
  EXPECT_EQ(robot_->components().size() - 1, robot_->status()->components().size());
}

TEST_F(Robot, IsBackWithinOneSecondAfterTheDeathOfAPart) {
  ASSERT_TRUE(booted()) << robot_->complaints();
  for (const auto* victim :
       {"amcl", "costmap", "movement_control", "segway_rmp", "local_planner"}) {
    SCOPED_TRACE(victim);
    const auto before = robot_->components();
    const auto old_epoch = robot_->status()->epoch();
    const auto old_writer = robot_->lives().at(victim).writer;
    const double slow = slowdown();
    const auto killed = std::chrono::steady_clock::now();
    ASSERT_EQ(::kill(before.at(victim), SIGKILL), 0);
    ASSERT_TRUE(robot_->wait_for([&] { return robot_->lives().at(victim).writer != old_writer; },
                                 Seconds(10.0 * slow)))
        << robot_->complaints();
    const Seconds back = robot_->lives().at(victim).at - killed;
    EXPECT_LT(back.count(), 1.0 * slow);
    // What the supervisor said before it could know does not count, nor does the right of the dead.
    const auto heard = robot_->status_count();
    const bool drove = victim == std::string("movement_control");
    const bool well = robot_->wait_for(
        [&] {
          return robot_->status_count() >= heard + 3 && robot_->may_drive() &&
                 robot_->lives().at(victim).state == STATE_OK &&
                 (!drove || robot_->status()->epoch() > old_epoch);
        },
        Seconds(10.0 * slow));
    const Seconds whole = std::chrono::steady_clock::now() - killed;
    EXPECT_TRUE(well) << robot_->complaints();
    EXPECT_LT(whole.count(), 1.0 * slow);
    std::printf(
        "%-16s heartbeat after %4.0f ms, the robot may drive again after %4.0f ms "
        "(machine %.1fx)\n",
        victim, back.count() * 1e3, whole.count() * 1e3, slow);
    auto after = robot_->components();
    EXPECT_NE(after[victim], before.at(victim));
    after[victim] = before.at(victim);
    EXPECT_EQ(after, before) << "nobody else was restarted";
  }
}

TEST_F(Robot, LeavesNothingBehindAfterSigterm) {
  ASSERT_TRUE(booted()) << robot_->complaints();
  const auto processes = robot_->components();
  const auto shared_memory = shared_memory_of(processes);
  robot_->launcher().signal(SIGTERM);
  EXPECT_EQ(robot_->launcher().wait(std::chrono::seconds(20)), 0) << robot_->launcher().errors();
  EXPECT_EQ(robot_->launcher().output().find("did not stop"), std::string::npos)
      << robot_->launcher().output();
  EXPECT_TRUE(robot_->components().empty());
  for (const auto& file : shared_memory) EXPECT_FALSE(std::filesystem::exists(file)) << file;
}

TEST_F(Robot, TakesItsPartsAlongWhenTheLauncherIsKilled) {
  robot_->launch();
  ASSERT_TRUE(booted()) << robot_->complaints();
  robot_->launcher().signal(SIGKILL);
  EXPECT_EQ(robot_->launcher().wait(), 128 + SIGKILL);
  EXPECT_TRUE(
      robot_->wait_for([] { return robot_->components().empty(); }, Seconds(5 * slowdown())))
      << robot_->components().begin()->first;
}

// The simulated world ends after the robot's movement was ended and before the base driver: what it
// says last is what the robot did when the others were taken away.
TEST_F(Robot, CanBeLaunchedAgainAndStandsOnCtrlCBeforeAnythingElseEnds) {
  std::atomic<double> speed{0.0};
  const auto truth = robot_->observer().reader(
      topics::kSimGroundTruth,
      [&](const auto& message, const auto&) { speed = std::abs(message.v()); });
  ASSERT_TRUE(truth) << truth.error();
  robot_->launch();
  ASSERT_TRUE(booted()) << robot_->complaints();
  const auto drive = robot_->command({"goto", "kitchen", "--no-wait"});
  EXPECT_EQ(drive->wait(), 0) << drive->errors();
  ASSERT_TRUE(robot_->wait_for([&] { return speed > 0.3; }, Seconds(60)));
  robot_->launcher().signal(SIGINT);
  EXPECT_EQ(robot_->launcher().wait(std::chrono::seconds(20)), 0) << robot_->launcher().output();
  EXPECT_NE(robot_->launcher().output().find("stopping: first the robot"), std::string::npos);
  EXPECT_EQ(robot_->launcher().output().find("was not seen to stand"), std::string::npos)
      << robot_->launcher().output();
  EXPECT_LT(speed, 0.1);
  EXPECT_TRUE(robot_->components().empty());
}

}  // namespace
}  // namespace usher::test
