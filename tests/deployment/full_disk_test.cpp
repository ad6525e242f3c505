// The disk with logs, parameters and what components keep fills up while the robot drives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <vector>

#include "deployment/driven_robot.hpp"

namespace usher::test {
namespace {

using testing::HasSubstr;
using namespace usher_msgs::msg;

/// A disk of 8 MB in a mount namespace of this process and its children.
class SmallDisk {
 public:
  explicit SmallDisk(std::string path) : path_(std::move(path)) {
    std::filesystem::create_directories(path_);
    mounted_ = unshare(CLONE_NEWNS) == 0 &&
               mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               mount("tmpfs", path_.c_str(), "tmpfs", 0, "size=8m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount2(path_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  bool mounted() const { return mounted_; }
  void fill() const {
    const int file = open(filler().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    const std::vector<char> block(4096);
    for (std::size_t size = block.size(); size > 0; size /= 2) {
      while (write(file, block.data(), size) > 0) {
      }
    }
    close(file);
  }
  void make_room() const { std::filesystem::remove(filler()); }

 private:
  std::string filler() const { return path_ + "/filler"; }
  std::string path_;
  bool mounted_ = false;
};

bool has_fault(const RunningRobot& robot, const std::string& words) {
  const auto status = robot.status();
  if (!status) return false;
  const auto& faults = status->faults();
  return std::any_of(faults.begin(), faults.end(), [&](const auto& fault) {
    return fault.active() && fault.cause().find(words) != std::string::npos;
  });
}

TEST(FullDisk, TheRobotDrivesOnObeysItsOperatorAndSaysSo) {
  const char* const kForgets = "a restart would forget";
  DrivenRobot robot;
  const SmallDisk disk(robot->folder() + "/small");
  if (!disk.mounted()) {
    std::printf("NO MOUNT NAMESPACES\n");
    GTEST_SKIP() << "mount namespaces are not permitted here";
  }
  robot->launcher().signal(SIGTERM);
  robot->launcher().wait();
  const std::string run = robot->folder() + "/small/run";
  robot->launch({}, {"--run-directory", run});

  // It fills while the robot drives: nothing ends, nothing stops, and it arrives.
  ASSERT_TRUE(robot.sets_out("reception")) << robot->complaints();
  const auto processes = robot->components();
  disk.fill();
  const auto full = robot->status()->epoch();
  ASSERT_EQ(robot.errand(std::chrono::seconds(120)), 0) << robot.errand_story() << robot.reason();
  EXPECT_EQ(robot->components(), processes) << robot->launcher().output();
  EXPECT_EQ(robot->status()->epoch(), full) << "the right to drive was never withdrawn";
  EXPECT_THAT(robot->launcher().output(), HasSubstr("the disk is full"));

  // A stop holds, and the operator reads that a restart would forget it.
  ASSERT_TRUE(robot.sets_out("foyer")) << robot->complaints();
  robot.forget();
  EXPECT_EQ(robot->command({"stop"})->wait(), 0);
  EXPECT_TRUE(robot->wait_for([&] { return robot.speed() < 0.02; }, Seconds(10)));
  EXPECT_TRUE(robot->wait_for([&] { return has_fault(*robot.operator->(), kForgets); }, Seconds(5)))
      << robot->complaints();
  const auto status = robot->command({"status"});
  EXPECT_EQ(status->wait(), 1);
  EXPECT_THAT(status->output(), HasSubstr("No space left on device"));
  EXPECT_EQ(robot->command({"move"})->wait(), 0);
  ASSERT_EQ(robot.errand(std::chrono::seconds(120)), 0) << robot.errand_story() << robot.reason();

  // So does an emergency stop, over the death of the supervisor, too.
  ASSERT_EQ(robot->command({"stop", "--emergency"})->wait(), 0);
  const auto in_fault = [&] {
    const auto now = robot->status();
    return now && now->state() == SupervisorStatus_Constants::STATE_FAULT && !now->granted();
  };
  EXPECT_TRUE(robot->wait_for(in_fault, Seconds(5)));
  const auto supervisor = robot->lives().at("supervisor").writer;
  ASSERT_EQ(::kill(robot->components().at("supervisor"), SIGKILL), 0);
  ASSERT_TRUE(robot->wait_for([&] { return robot->lives().at("supervisor").writer != supervisor; },
                              Seconds(20)));
  const auto heard = robot->status_count();
  EXPECT_TRUE(robot->wait_for([&] { return robot->status_count() >= heard + 3 && in_fault(); },
                              Seconds(10)))
      << robot->complaints();

  // With room again all is kept: the emergency stop over the death of both who know of it.
  EXPECT_FALSE(std::filesystem::exists(run + "/kept/segway_rmp/emergency"));
  disk.make_room();
  EXPECT_TRUE(robot->wait_for(
      [&] {
        return !has_fault(*robot.operator->(), kForgets) &&
               std::filesystem::exists(run + "/kept/segway_rmp/emergency");
      },
      Seconds(10)))
      << robot->complaints();
  EXPECT_TRUE(robot->wait_for(
      [&] {
        return robot->launcher().output().find("the disk has room again") != std::string::npos;
      },
      Seconds(10)));
  const auto processes_then = robot->components();
  for (const auto* victim : {"supervisor", "segway_rmp"})
    ::kill(processes_then.at(victim), SIGKILL);
  ASSERT_TRUE(robot->wait_for(
      [&] {
        const auto now = robot->components();
        return now.contains("supervisor") && now.contains("segway_rmp");
      },
      Seconds(20)));
  const auto heard_then = robot->status_count();
  EXPECT_TRUE(robot->wait_for([&] { return robot->status_count() >= heard_then + 5 && in_fault(); },
                              Seconds(20)))
      << robot->complaints();
  EXPECT_TRUE(robot.is_ready()) << robot->complaints();
  EXPECT_EQ(robot.contacts(), 0U);
}

}  // namespace
}  // namespace usher::test
