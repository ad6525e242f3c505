// One robot on two machines: network namespaces with a cable between them that the test plays.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "deployment/running_robot.hpp"
#include "deployment/two_hosts.hpp"
#include "support/sanitizer.hpp"
#include "support/test_domain.hpp"

namespace usher::test {
namespace {

using std::chrono::milliseconds;

/// The simulated MARVIN whose guide runs on the second machine: what the tablet's part is to the
/// robot.
class GuideElsewhere {
 public:
  GuideElsewhere(TwoNetworks& networks, const std::string& lines, bool secure = false,
                 bool discovery_server = false)
      : hosts_(networks, folder_,
               {.lines = lines + "components:\n  guide: {host: tablet}\n",
                .secure = secure,
                .discovery_server = discovery_server,
                .listen = [this](runtime::Observer& observer) {
                  auto truths = observer.reader(
                      topics::kSimGroundTruth,
                      [this](const auto& m, const auto&) { speed_ = std::abs(m.v()); });
                  ASSERT_TRUE(truths);
                  truths_ = std::move(truths).value();
                }}) {}
  ~GuideElsewhere() { truths_.reset(); }

  TwoHosts* operator->() { return &hosts_; }
  bool guide_is_ok() const { return hosts_.is_ok("guide"); }
  double speed() const { return speed_; }

 private:
  Folder folder_;
  std::atomic<double> speed_{0.0};
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truths_;
  TwoHosts hosts_;
};

const Line kCut{.cut = true};
const Line kGood{};

TEST(Hosts, LosingTheTabletIsAModeNotACrash) {
  const auto networks = two_networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuideElsewhere robot(*networks, "");
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();

  // Fully cut while it drives.
  const auto errand = robot->command({"goto", "--pose", "4.5", "5.3", "1.5708"});
  ASSERT_TRUE(robot->wait_for([&] { return robot.speed() > 0.1; }, Seconds(30))) << robot->story();
  networks->set(kCut, kCut);
  bool lost_the_right = false;
  const auto has_the_right = [&] {
    lost_the_right = lost_the_right || !robot->granted();
    return !lost_the_right;
  };
  ASSERT_TRUE(robot->wait_for([&] { return has_the_right() && !robot.guide_is_ok(); }, Seconds(10)))
      << robot->story();
  EXPECT_TRUE(robot->wait_for(
      [&] { return has_the_right() && errand->output().find("arrived") != std::string::npos; },
      Seconds(120)))
      << errand->output() << robot->story();
  EXPECT_EQ(errand->wait(), 0) << errand->output() << robot->story();
  EXPECT_FALSE(lost_the_right) << "the drive chain on the nuc goes on";
  EXPECT_TRUE(robot->granted()) << robot->story();
  EXPECT_TRUE(robot->wait_for([&] { return robot.speed() < 0.01; }, Seconds(10))) << "it parks";
  const auto status = robot->command({"status"});
  EXPECT_EQ(status->wait(), 1) << "and says so";
  EXPECT_NE(status->output().find("guide"), std::string::npos) << status->output();

  networks->set(kGood, kGood);
  const auto restored = std::chrono::steady_clock::now();
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20))) << robot->story();
  const Seconds back = std::chrono::steady_clock::now() - restored;
  std::printf("the second host is back %.2f s after the link\n", back.count());
  EXPECT_LT(back.count(), 3.0 * slowdown());

  // One way: the nuc hears the tablet, but not the other way round; then the reverse.
  networks->set(kCut, kGood);
  ASSERT_TRUE(robot->wait_for([&] { return !robot.guide_is_ok(); }, Seconds(10)))
      << "it hears nothing of the robot, and says so\n"
      << robot->story();
  EXPECT_TRUE(robot->granted()) << robot->story();
  networks->set(kGood, kGood);
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20))) << robot->story();
  networks->set(kGood, kCut);
  ASSERT_TRUE(robot->wait_for([&] { return !robot.guide_is_ok(); }, Seconds(10)));
  EXPECT_TRUE(robot->granted()) << robot->story();
  networks->set(kGood, kGood);
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20))) << robot->story();
}

/// The simulated MARVIN with a visitor who wants to be guided: he touches what leads to a place, as
/// long as the guide offers it.
class GuidedVisit {
 public:
  GuidedVisit(TwoNetworks& networks, const std::string& place)
      : place_(place),
        hosts_(networks, folder_,
               {.listen = [this](runtime::Observer& observer) { listen(observer); }}) {}
  ~GuidedVisit() {
    truths_.reset();
    screens_.reset();
    answers_.reset();
  }

  TwoHosts* operator->() { return &hosts_; }
  double speed() const { return speed_; }
  std::string state() const {
    const std::lock_guard lock(mutex_);
    return screen_.state();
  }
  /// Waits as the hosts do; the visitor answers meanwhile.
  bool wait_for(const std::function<bool()>& condition, Seconds limit) {
    return hosts_.wait_for(
        [&] {
          answer();
          return condition();
        },
        limit);
  }

 private:
  void listen(runtime::Observer& observer) {
    auto truths = observer.reader(topics::kSimGroundTruth,
                                  [this](const auto& m, const auto&) { speed_ = std::abs(m.v()); });
    auto screens = observer.reader(topics::kDialogueScreen, [this](const auto& m, const auto&) {
      const std::lock_guard lock(mutex_);
      screen_ = m;
    });
    auto answers = observer.writer(topics::kDialogueAnswer);
    ASSERT_TRUE(truths && screens && answers);
    truths_ = std::move(truths).value();
    screens_ = std::move(screens).value();
    answers_ = std::move(answers).value();
  }
  void answer() {
    const std::lock_guard lock(mutex_);
    const std::vector<std::string> wishes =
        screen_.state() == "inactive" ? std::vector<std::string>{"language:en"}
                                      : std::vector<std::string>{place_, "guide_me", "start"};
    for (const std::string& wanted : wishes) {
      for (const auto& option : screen_.options()) {
        if (option.id() != wanted) continue;
        usher_msgs::msg::DialogueAnswer answer;
        answer.id(screen_.id());
        answer.client("operator");
        answer.screen_id(screen_.id());
        answer.option_id(wanted);
        answers_->write(answer);
        return;
      }
    }
  }

  Folder folder_;
  const std::string place_;
  std::atomic<double> speed_{0.0};
  mutable std::mutex mutex_;
  usher_msgs::msg::DialogueScreen screen_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truths_;
  std::optional<runtime::Observer::Reader<usher_msgs::msg::DialogueScreen>> screens_;
  std::optional<runtime::Observer::Writer<usher_msgs::msg::DialogueAnswer>> answers_;
  TwoHosts hosts_;
};

TEST(Hosts, LosingTheTabletInAVisitEndsNoVisit) {
  const auto networks = two_networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuidedVisit robot(*networks, "reception");
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();
  ASSERT_TRUE(robot.wait_for([&] { return robot.state() == "guide_active" && robot.speed() > 0.2; },
                             Seconds(60)))
      << robot.state() << "\n"
      << robot->story();
  networks->set(kCut, kCut);
  bool lost_the_right = false;
  const auto has_the_right = [&] {
    lost_the_right = lost_the_right || !robot->granted();
    return !lost_the_right;
  };
  ASSERT_TRUE(
      robot->wait_for([&] { return has_the_right() && !robot->is_ok("tablet"); }, Seconds(10)))
      << robot->story();
  EXPECT_EQ(robot.state(), "guide_active") << "lost on the way";
  EXPECT_TRUE(robot->wait_for([&] { return has_the_right() && robot.state() == "guide_success"; },
                              Seconds(90)))
      << robot.state() << "\n"
      << robot->story();
  EXPECT_FALSE(lost_the_right);
  EXPECT_TRUE(robot->wait_for([&] { return robot.speed() < 0.01; }, Seconds(10))) << "it parks";
  const auto status = robot->command({"status"});
  EXPECT_EQ(status->wait(), 1);
  EXPECT_THAT(status->output(), testing::ContainsRegex("\ntablet +missing"));

  networks->set(kGood, kGood);
  const auto restored = std::chrono::steady_clock::now();
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20))) << robot->story();
  const Seconds back = std::chrono::steady_clock::now() - restored;
  std::printf("the tablet is back %.2f s after the link\n", back.count());
  EXPECT_LT(back.count(), 3.0 * slowdown());
}

TEST(Hosts, ABadLinkDoesNotReachTheDriveChain) {
  const auto networks = two_networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuideElsewhere robot(*networks, "");
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();
  const Line bad{.loss = 0.1, .delay = milliseconds(30), .jitter = milliseconds(40)};
  networks->set(bad, bad);
  bool lost_the_right = false;
  const auto errand = robot->command({"goto", "--pose", "4.5", "5.3", "1.5708"});
  robot->wait_for(
      [&] {
        lost_the_right = lost_the_right || !robot->granted();
        return errand->output().find("arrived") != std::string::npos;
      },
      Seconds(120));
  EXPECT_EQ(errand->wait(), 0) << errand->output() << errand->errors() << robot->story();
  EXPECT_FALSE(lost_the_right);
  EXPECT_TRUE(robot->wait_for([&] { return robot.guide_is_ok(); }, Seconds(10)))
      << "10 % loss, 30 to 70 ms, frames out of order: still there\n"
      << robot->story();
  EXPECT_GT(networks->frames(), 1000U) << "the link was used";
}

/// What deploy/marvin-sim.yaml makes of the manifest that it extends.
std::string simulated() {
  std::string text = content_of(USHER_SOURCE_DIR "/deploy/marvin-sim.yaml");
  const std::string extends = "extends: marvin.yaml\n";
  const auto at = text.find(extends);
  assert(at != std::string::npos);
  return text.erase(at, extends.size());
}

/// deploy/marvin-three-hosts.yaml in simulation: laser, sensor board and scan filter run on the
/// second machine, and a judge at its wheels on the first.
class SensingElsewhere {
 public:
  using Clock = std::chrono::steady_clock;

  explicit SensingElsewhere(TwoNetworks& networks)
      : hosts_(networks, folder_,
               {.base = "marvin-three-hosts.yaml",
                .lines = simulated(),
                .hosts_of_a = {"nuc", "tablet"},
                .hosts_of_b = {"sensing"},
                .listen = [this](runtime::Observer& observer) {
                  auto wheels =
                      observer.reader(topics::kSimBaseCommand, [this](const auto& m, const auto&) {
                        const std::lock_guard lock(mutex_);
                        if (m.v() == 0.0 && !zero_) zero_ = Clock::now();
                        v_ = m.v();
                      });
                  ASSERT_TRUE(wheels);
                  wheels_ = std::move(wheels).value();
                }}) {}
  ~SensingElsewhere() { wheels_.reset(); }

  TwoHosts* operator->() { return &hosts_; }
  bool drives() const {
    const std::lock_guard lock(mutex_);
    return v_ > 0.2;
  }
  void forget() {
    const std::lock_guard lock(mutex_);
    zero_.reset();
  }
  std::optional<Clock::time_point> zero() const {
    const std::lock_guard lock(mutex_);
    return zero_;
  }

 private:
  Folder folder_;
  mutable std::mutex mutex_;
  double v_ = 0.0;
  std::optional<Clock::time_point> zero_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::BaseCommand>> wheels_;
  TwoHosts hosts_;
};

// What is lost with the line is critical, and lives: it is silent.
TEST(Hosts, LosingTheHostOfASensorStopsTheRobotInTime) {
  constexpr double kFirstZero = 0.2;  // [s] the promise
  const auto networks = two_networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  SensingElsewhere robot(*networks);
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();
  const auto errand = robot->command({"goto", "lounge"});
  std::vector<double> took;
  const std::pair<Line, Line> cuts[] = {{kCut, kCut}, {kGood, kCut}};
  for (int i = 0; i < 6; ++i) {
    ASSERT_TRUE(robot->wait_for([&] { return robot.drives(); }, Seconds(30))) << robot->story();
    // Another phase of the heartbeats.
    robot->wait_for([] { return false; }, Seconds(0.5 + 0.007 * i));
    ASSERT_TRUE(robot->wait_for([&] { return robot.drives(); }, Seconds(30))) << robot->story();
    const double slow = slowdown();
    robot.forget();
    const auto cut = SensingElsewhere::Clock::now();
    networks->set(cuts[i % 2].first, cuts[i % 2].second);
    EXPECT_TRUE(robot->wait_for([&] { return robot.zero().has_value(); }, Seconds(2)))
        << robot->story();
    const auto zero = robot.zero().value_or(SensingElsewhere::Clock::time_point::max());
    took.push_back(Seconds(zero - cut).count());
    EXPECT_LT(took.back(), kFirstZero * slow);
    EXPECT_TRUE(robot->wait_for([&] { return !robot->granted(); }, Seconds(2)));
    EXPECT_NE(robot->status()->reason(), "");
    std::printf("line cut %s: first zero after %.0f ms (%s; machine %.1fx)\n",
                i % 2 == 0 ? "both ways" : "one way", took.back() * 1e3,
                robot->status()->reason().c_str(), slow);
    networks->set(kGood, kGood);
    ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20)))
        << robot->story();
  }
  std::ranges::sort(took);
  std::printf("first zero: p50 %.0f ms, max %.0f ms\n", took[took.size() / 2] * 1e3,
              took.back() * 1e3);
  EXPECT_TRUE(robot->wait_for([&] { return robot.drives(); }, Seconds(30)))
      << "and it drives on\n"
      << robot->story() << errand->output() << errand->errors();
}

TEST(Hosts, MeetAcrossARouterByPeers) {
  const auto networks = two_networks(TwoNetworks::Kind::kRouted);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuideElsewhere robot(*networks, "hosts:\n  nuc: {peers: [" + networks->address_of_b() +
                                      "]}\n  tablet: {peers: [" + networks->address_of_a() +
                                      "]}\n");
  EXPECT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();
}

TEST(Hosts, MeetAcrossARouterByADiscoveryServerWhoseDeathStopsNothing) {
  const char* const kServer = "discovery_server";
  const auto networks = two_networks(TwoNetworks::Kind::kRouted);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuideElsewhere robot(*networks, "", false, true);
  ASSERT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(90))) << robot->story();
  const auto errand = robot->command({"goto", "reception"});
  ASSERT_TRUE(robot->wait_for([&] { return robot.speed() > 0.2; }, Seconds(30)))
      << robot->story() << errand->errors();

  // On the way it hangs for longer than any lease, then it is killed, and the launcher starts it
  // again: the robot drives on.
  const pid_t first = robot->components().at(kServer);
  bool lost_the_right = false;
  const auto arrived = [&] {
    lost_the_right = lost_the_right || !robot->granted();
    return errand->output().find("arrived") != std::string::npos || !errand->errors().empty();
  };
  ::kill(first, SIGSTOP);
  EXPECT_FALSE(robot->wait_for(arrived, Seconds(1.5)));
  ::kill(first, SIGKILL);
  ASSERT_TRUE(robot->wait_for(arrived, Seconds(120))) << robot->story();
  EXPECT_EQ(errand->wait(), 0) << errand->errors();
  EXPECT_FALSE(lost_the_right) << robot->story();
  EXPECT_NE(robot->components().at(kServer), first);
  EXPECT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(10))) << robot->story();

  // Who starts now is found by the next one: a component on each host, and an operator.
  for (const auto* victim : {"amcl", "guide"}) {
    const pid_t before = robot->components().at(victim);
    ::kill(before, SIGKILL);
    ASSERT_TRUE(robot->wait_for(
        [&] {
          const auto now = robot->components();
          return now.contains(victim) && now.at(victim) != before;
        },
        Seconds(10)))
        << victim;
    EXPECT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(20)))
        << victim << "\n"
        << robot->story();
  }
  const auto stop = robot->command({"stop"});
  EXPECT_EQ(stop->wait(), 0) << stop->errors();
}

TEST(Hosts, MeetAcrossARouterWithSecurity) {
  if (signing_robot_starves()) GTEST_SKIP() << kSigningRobotStarves;
  const auto networks = two_networks(TwoNetworks::Kind::kRouted);
  if (!networks) GTEST_SKIP() << kNoNamespaces;
  GuideElsewhere robot(*networks,
                       "hosts:\n  nuc: {peers: [" + networks->address_of_b() +
                           "]}\n  tablet: {peers: [" + networks->address_of_a() + "]}\n",
                       true);
  EXPECT_TRUE(robot->wait_for([&] { return robot->all_is_well(); }, Seconds(130)))
      << robot->story();
}

}  // namespace
}  // namespace usher::test
