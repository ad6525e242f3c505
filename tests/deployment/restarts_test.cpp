// The parts of the robot are killed while it drives.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <random>

#include "deployment/driven_robot.hpp"

namespace usher::test {
namespace {

using usher_msgs::msg::Heartbeat_Constants::STATE_DEGRADED;
using usher_msgs::msg::Heartbeat_Constants::STATE_OK;
using Clock = DrivenRobot::Clock;

/// What the robot's motion hangs on, the base's driver included.
constexpr const char* kDriveChain[] = {"supervisor",     "movement_control", "segway_rmp",
                                       "lms100",         "sensor_board",     "scan_filter",
                                       "amcl",           "costmap",          "local_planner",
                                       "navigator",      "map_server",       "global_planner",
                                       "people_detector"};
/// What only visitors meet: later back, by promise.
constexpr const char* kVisitorsSide[] = {"tablet", "speech"};
/// What moves the robot for others than the navigation, and who asks for it.
constexpr const char* kBesideIt[] = {"guide", "interaction_control", "manual_control", "gamepad",
                                     "torso"};
constexpr double kBack = 1.0, kVisitorsSideBack = 3.0;  // [s] the promise
constexpr double kDriving = 0.2;                        // [m/s]
constexpr double kGuardBack = 1.0;                      // [s] from a hang of the guard on
constexpr double kWithoutGrant = 0.2;  // [s] a grant's life, and the way to the judge
constexpr unsigned kSeed = 20;
/// USHER_KILL_SEED: another order of kills.
unsigned seed() {
  const char* const wanted = std::getenv("USHER_KILL_SEED");
  return wanted != nullptr ? static_cast<unsigned>(std::strtoul(wanted, nullptr, 10)) : kSeed;
}
/// Whoever is killed, and does not hang, is killed as often once more as soon as it runs again.
constexpr int kAgain = 2;
/// Errands that may be given up: the errand's program does so when the navigator is silent for 5 s,
/// as long as the launcher waits for one that hangs, and the navigator when no plan comes for long.
/// Whoever else ends delays the errand only.
constexpr int kMostGivenUp = 2;

std::vector<std::string> everybody() {
  std::vector<std::string> names(std::begin(kDriveChain), std::end(kDriveChain));
  names.insert(names.end(), std::begin(kVisitorsSide), std::end(kVisitorsSide));
  names.insert(names.end(), std::begin(kBesideIt), std::end(kBesideIt));
  return names;
}

class Restarts : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string more;
    for (const auto& name : everybody()) {
      if (name != "segway_rmp" && name != "speech")
        more += "  " + name + ": {restart_budget: 1000}\n";
    }
    more +=
        "  speech: {host: tablet, criticality: notify, restart_budget: 1000, "
        "heartbeat_timeout: 1.0, parameters: {texts: " +
        std::string(USHER_SOURCE_DIR) + "/config/dialogue/en.yaml}}\n";
    robot_ = new DrivenRobot(more);
  }
  static void TearDownTestSuite() {
    delete robot_;
    robot_ = nullptr;
  }
  static DrivenRobot& robot() { return *robot_; }
  static RunningRobot& running() { return *robot_->operator->(); }

  static bool drives() {
    return running().wait_for([] { return robot().speed() > kDriving; }, Seconds(20));
  }
  static std::string story() { return running().complaints() + robot().errand_story(); }

  /// Kills it while the robot drives; until it is heard again [s].
  static double until_heard(const std::string& victim) {
    const auto life = running().lives().at(victim).writer;
    const auto killed = Clock::now();
    EXPECT_EQ(::kill(running().components().at(victim), SIGKILL), 0);
    EXPECT_TRUE(running().wait_for(
        [&] {
          const auto now = running().lives().at(victim);
          // There need be no sound card.
          return now.writer != life && (now.state == STATE_OK || now.state == STATE_DEGRADED);
        },
        Seconds(20)))
        << victim << "\n"
        << running().complaints();
    return Seconds(Clock::now() - killed).count();
  }

  static DrivenRobot* robot_;
};
DrivenRobot* Restarts::robot_ = nullptr;

TEST_F(Restarts, OfEachPartTakeASecondAndTheErrandGoesOn) {
  std::vector<std::string> victims(std::begin(kDriveChain), std::end(kDriveChain));
  victims.insert(victims.end(), std::begin(kVisitorsSide), std::end(kVisitorsSide));
  ASSERT_TRUE(robot().sets_out("lounge")) << story();
  bool far = true;
  for (const auto& victim : victims) {
    SCOPED_TRACE(victim);
    if (!robot().under_way()) {
      ASSERT_EQ(robot().errand(std::chrono::seconds(1)), 0) << story();
      far = !far;
      ASSERT_TRUE(robot().sets_out(far ? "lounge" : "foyer")) << story();
    }
    ASSERT_TRUE(drives()) << story();
    const double slow = slowdown();
    const auto killed = Clock::now();
    const double back = until_heard(victim);
    const bool visitors_side = std::ranges::count(kVisitorsSide, victim) > 0;
    EXPECT_LT(back, (visitors_side ? kVisitorsSideBack : kBack) * slow);
    const auto heard = running().status_count();
    EXPECT_TRUE(running().wait_for(
        [&] { return running().status_count() >= heard + 2 && robot().may_drive(); }, Seconds(10)))
        << story();
    const Seconds whole = Clock::now() - killed;
    EXPECT_TRUE(!robot().under_way() || drives()) << story();
    const Seconds goes_on = Clock::now() - killed;
    std::printf(
        "%-16s ok after %4.2f s, may drive after %4.2f s, drives after %4.2f s (machine %.1fx)\n",
        victim.c_str(), back, whole.count(), goes_on.count(), slow);
  }
  EXPECT_EQ(robot().cleared(), "") << "who comes back needs no operator";
  EXPECT_EQ(robot().contacts(), 0U);
}

TEST_F(Restarts, AGuardThatHangsIsReplacedAndTheBaseIsDisconnectedMeanwhile) {
  using usher_msgs::msg::BaseStatus_Constants::STATE_BALANCING;
  using usher_msgs::msg::BaseStatus_Constants::STATE_DISCONNECTED;
  std::mutex mutex;
  std::uint8_t state = STATE_DISCONNECTED;
  const auto base =
      running().observer().reader(topics::kBaseStatus, [&](const auto& message, const auto&) {
        const std::scoped_lock lock(mutex);
        state = message.state();
      });
  ASSERT_TRUE(base);
  const auto is = [&](std::uint8_t wanted) {
    const std::scoped_lock lock(mutex);
    return state == wanted;
  };
  ASSERT_TRUE(robot().under_way() || robot().sets_out("lounge") || robot().sets_out("foyer"))
      << story();
  ASSERT_TRUE(drives()) << story();
  const pid_t guard = guard_of(running().components().at("segway_rmp"));
  ASSERT_GT(guard, 0);
  const double slow = slowdown();
  const auto hung = Clock::now();
  ::kill(guard, SIGSTOP);
  ASSERT_TRUE(running().wait_for([&] { return is(STATE_DISCONNECTED); }, Seconds(10))) << story();
  const Seconds gone = Clock::now() - hung;
  ASSERT_TRUE(running().wait_for([&] { return is(STATE_BALANCING); }, Seconds(10))) << story();
  const Seconds back = Clock::now() - hung;
  std::printf("guard hung: disconnected after %4.2f s, back after %4.2f s (machine %.1fx)\n",
              gone.count(), back.count(), slow);
  EXPECT_LT(back.count(), kGuardBack * slow);
  EXPECT_EQ(::kill(guard, 0), -1);
  EXPECT_TRUE(robot().is_ready()) << story();
  EXPECT_EQ(robot().cleared(), "");
  EXPECT_EQ(robot().contacts(), 0U);
}

TEST_F(Restarts, AtRandomTimesEndOnTheWayOrInAStopWithAReason) {
  std::mt19937 random(seed());
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  bool far = true;
  ASSERT_TRUE(robot().under_way() || robot().sets_out("lounge") || robot().sets_out("foyer"))
      << story();
  robot().forget();
  const double slow = slowdown();
  int failed = 0, hung = 0, killed = 0;
  auto victims = everybody();
  for (std::size_t i = victims.size(); i > 1; --i) std::swap(victims[i - 1], victims[random() % i]);
  std::string kills;
  for (const auto& victim : victims) {
    const double pause = draw(0.1, 2.0);
    running().wait_for([] { return false; }, Seconds(pause));
    const bool hangs = random() % 2 == 0;  // until the launcher kills it
    pid_t harmed = 0;
    // Who is away just then runs again soon.
    const auto is_harmed = [&] {
      const auto processes = running().components();
      const auto found = processes.find(victim);
      if (found == processes.end() || found->second == harmed) return false;
      if (::kill(found->second, hangs ? SIGSTOP : SIGKILL) != 0) return false;
      harmed = found->second;
      return true;
    };
    for (int life = 0; life < (hangs ? 1 : 1 + kAgain); ++life) {
      ASSERT_TRUE(running().wait_for(is_harmed, Seconds(20))) << victim << life << story();
      ++(hangs ? hung : killed);
    }
    kills += "after " + std::to_string(pause) + " s: " + victim + (hangs ? " hangs " : " ") +
             robot().contact_story() + "\n";
    if (robot().under_way()) continue;
    if (robot().errand(std::chrono::seconds(1)) != 0) {
      ++failed;
      EXPECT_THAT(robot().errand_story(), testing::ContainsRegex("usher: .{10}")) << "a reason";
    }
    far = !far;
    ASSERT_TRUE(robot().sets_out(far ? "lounge" : "foyer")) << story();
  }
  ASSERT_TRUE(robot().is_ready()) << story();
  EXPECT_TRUE(!robot().under_way() || drives() || !robot().under_way()) << story();
  EXPECT_EQ(robot().cleared(), "") << kills;
  std::printf(
      "seed %u: %d kills and %d hangs, %d errands given up, longest motion after a grant %.3f s\n",
      seed(), killed, hung, failed, robot().longest_without_grant());
  EXPECT_LE(failed, kMostGivenUp) << kills << story();
  EXPECT_LT(robot().longest_without_grant(), kWithoutGrant * slow);
  EXPECT_EQ(robot().contacts(), 0U) << kills << robot().contact_story() << story();
}

}  // namespace
}  // namespace usher::test
