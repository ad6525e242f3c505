// The wall clock of the robot's machine is set while it drives: components measure by the monotonic
// one. The jump is played to the robot's processes alone (libfaketime); monotonic clocks that jump
// against each other are in the fault windows.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <utility>

#include "deployment/driven_robot.hpp"

namespace usher::test {
namespace {

namespace fs = std::filesystem;

/// USHER_FAKETIME names it where it is not installed; empty when there is none.
std::string faketime() {
  if (const char* const path = std::getenv("USHER_FAKETIME")) return path;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/usr/lib", error)) {
    const fs::path library = entry.path() / "faketime/libfaketimeMT.so.1";
    if (fs::exists(library, error)) return library;
  }
  return {};
}

class WallClock {
 public:
  explicit WallClock(std::string path) : path_(std::move(path)) { set("+0"); }
  /// Against the machine's, in seconds.
  void set(const std::string& offset) const {
    std::ofstream(path_ + ".new") << offset << "\n";
    fs::rename(path_ + ".new", path_);
  }
  std::vector<std::string> for_a_launcher(const std::string& library) const {
    return {"/usr/bin/env", "LD_PRELOAD=" + library, "FAKETIME_DONT_FAKE_MONOTONIC=1",
            "FAKETIME_CACHE_DURATION=1", "FAKETIME_TIMESTAMP_FILE=" + path_};
  }

 private:
  std::string path_;
};

TEST(WallClockJumps, ChangeNothing) {
  const std::string library = faketime();
  if (library.empty()) {
    std::printf("NO FAKETIME: apt install faketime\n");
    GTEST_SKIP() << "libfaketime is not installed";
  }
  DrivenRobot robot;
  robot->launcher().signal(SIGTERM);
  robot->launcher().wait();
  const WallClock clock(robot->folder() + "/clock");
  robot->launch(clock.for_a_launcher(library));
  ASSERT_TRUE(robot.sets_out("reception")) << robot->complaints();
  const auto processes = robot->components();
  const auto jump = [&](const char* offset) {
    const auto epoch = robot->status()->epoch();
    clock.set(offset);
    robot->wait_for([] { return false; }, Seconds(2.0));  // each process looks once a second
    return robot.reason().empty() && robot->status()->epoch() == epoch;
  };
  const char* before = "+0";
  bool once = false;  // a heartbeat may be late by chance on a busy machine
  for (const char* offset : {"+3600", "-3600", "+0.5"}) {
    if (!jump(offset)) {
      EXPECT_FALSE(std::exchange(once, true)) << robot->fault_story();
      std::printf("at %s: %s\n", offset, robot->fault_story().c_str());
      ASSERT_TRUE(robot->wait_for([&] { return robot.may_drive(); }, Seconds(10)));
      jump(before);
      ASSERT_TRUE(robot->wait_for([&] { return robot.may_drive(); }, Seconds(10)));
      EXPECT_TRUE(jump(offset)) << "the right to drive was withdrawn at " << offset << "\n"
                                << robot->fault_story();
    }
    before = offset;
  }
  EXPECT_EQ(robot.errand(std::chrono::seconds(120)), 0) << robot.errand_story() << robot.reason();
  EXPECT_EQ(robot->components(), processes) << robot->launcher().output();

  // Whoever is restarted has the clock of the others.
  clock.set("-7200");
  const auto then = std::time(nullptr) - 7200;
  std::vector<std::string> date = clock.for_a_launcher(library);
  date.insert(date.end(), {"/bin/date", "+%s"});
  Process shown(date);
  ASSERT_EQ(shown.wait(), 0) << shown.errors();
  EXPECT_NEAR(static_cast<double>(std::stoll(shown.output())), static_cast<double>(then), 60.0)
      << "the jump is a jump";
  const auto life = robot->lives().at("amcl").writer;
  ASSERT_EQ(::kill(robot->components().at("amcl"), SIGKILL), 0);
  ASSERT_TRUE(
      robot->wait_for([&] { return robot->lives().at("amcl").writer != life; }, Seconds(20)));
  EXPECT_TRUE(robot.sets_out("foyer")) << robot->complaints() << robot.errand_story();
  EXPECT_EQ(robot.contacts(), 0U);
}

}  // namespace
}  // namespace usher::test
