// One robot on two machines: network namespaces with a cable between them that the test plays.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "deployment/running_robot.hpp"
#include "deployment/two_networks.hpp"
#include "support/sanitizer.hpp"
#include "support/test_domain.hpp"

namespace usher::test {
namespace {

using namespace usher_msgs::msg;

using std::chrono::milliseconds;

/// The simulated MARVIN whose guide runs on the second machine: what the tablet's part is to the
/// robot.
class TwoHosts {
 public:
  TwoHosts(TwoNetworks& networks, const std::string& manifest_lines, bool secure = false)
      : networks_(networks), domain_(test_domain()) {
    manifest_ = folder_.file("deploy/robot.yaml",
                             "extends: " + std::string(USHER_SOURCE_DIR) +
                                 "/deploy/marvin-sim.yaml\ndomain: " + std::to_string(domain_) +
                                 "\n" + (secure ? "security: keys\n" : "") + manifest_lines +
                                 "components:\n  guide: {host: tablet}\n");
    if (secure) {
      Process keys(
          {usher_program(), "keys", folder_.path() + "/deploy/keys", "--manifest", manifest_});
      EXPECT_EQ(keys.wait(), 0) << keys.errors();
    }
    for (const char* host : {"/nuc", "/tablet"})
      std::filesystem::create_directories(folder_.path() + host);
    ::setenv("XDG_RUNTIME_DIR", (folder_.path() + "/nuc").c_str(), 1);
    nuc_ =
        TwoNetworks::start(networks.a(), {usher_program(), "launch", manifest_, "--host", "nuc"});
    ::setenv("XDG_RUNTIME_DIR", (folder_.path() + "/tablet").c_str(), 1);
    tablet_ = TwoNetworks::start(networks.b(),
                                 {usher_program(), "launch", manifest_, "--host", "tablet"});
    ::setenv("XDG_RUNTIME_DIR", (folder_.path() + "/nuc").c_str(), 1);
    TwoNetworks::within(networks.a(), [&] { listen(secure); });
  }
  ~TwoHosts() {
    statuses_.reset();
    truths_.reset();
    observer_.reset();
    for (auto* launcher : {nuc_.get(), tablet_.get()}) {
      launcher->signal(SIGTERM);
      launcher->wait(std::chrono::seconds(10));
    }
  }

  template <class Condition>
  bool wait_for(Condition condition, Seconds limit) const {
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return true;
  }
  std::optional<SupervisorStatus> status() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }
  bool granted() const {
    const auto now = status();
    return now && now->granted();
  }
  std::uint8_t health_of(const std::string& component) const {
    const auto now = status();
    if (!now) return SupervisorStatus_Constants::HEALTH_MISSING;
    for (const auto& entry : now->components()) {
      if (entry.name() == component) return entry.health();
    }
    return SupervisorStatus_Constants::HEALTH_MISSING;
  }
  bool guide_is_ok() const { return health_of("guide") == SupervisorStatus_Constants::HEALTH_OK; }
  bool all_is_well() const {
    const auto now = status();
    return now && now->granted() && std::ranges::all_of(now->components(), is_well);
  }
  double speed() const { return speed_; }
  std::unique_ptr<Process> command(std::vector<std::string> words) const {
    words.insert(words.begin(), usher_program());
    words.insert(words.end(), {"--domain", std::to_string(domain_)});
    return TwoNetworks::start(networks_.a(), words);
  }
  std::string story() const {
    std::string text = nuc_->output() + nuc_->errors() + tablet_->output() + tablet_->errors();
    if (const auto now = status()) {
      text += now->granted() ? "granted\n" : "not granted: " + now->reason() + "\n";
      for (const auto& component : now->components()) {
        if (!is_well(component)) text += component.name() + ": " + component.reason() + "\n";
      }
    }
    return text;
  }

 private:
  void listen(bool secure) {
    auto made = runtime::Observer::create(
        {.name = "tests",
         .host = "nuc",
         .domain = domain_,
         .peers = {"127.0.0.1"},
         .identity = secure ? folder_.path() + "/deploy/keys/operator" : std::string()});
    ASSERT_TRUE(made) << made.error();
    observer_ = std::move(made).value();
    auto statuses =
        observer_->reader(topics::kSupervisorStatus, [this](const auto& message, const auto&) {
          const std::lock_guard lock(mutex_);
          status_ = message;
        });
    auto truths = observer_->reader(
        topics::kSimGroundTruth, [this](const auto& m, const auto&) { speed_ = std::abs(m.v()); });
    ASSERT_TRUE(statuses && truths);
    statuses_ = std::move(statuses).value();
    truths_ = std::move(truths).value();
  }

  TwoNetworks& networks_;
  Folder folder_;
  std::uint32_t domain_;
  std::string manifest_;
  std::unique_ptr<Process> nuc_, tablet_;
  mutable std::mutex mutex_;
  std::optional<SupervisorStatus> status_;
  std::atomic<double> speed_{0.0};
  std::unique_ptr<runtime::Observer> observer_;
  std::optional<runtime::Observer::Reader<SupervisorStatus>> statuses_;
  std::optional<runtime::Observer::Reader<usher_sim_msgs::msg::GroundTruth>> truths_;
};

const Line kCut{.cut = true};
const Line kGood{};

class Hosts : public testing::Test {
 protected:
  /// Skips the test, loudly, where the machine does not permit namespaces.
  static std::unique_ptr<TwoNetworks> networks(TwoNetworks::Kind kind) {
    std::string why;
    auto made = TwoNetworks::create(kind, why);
    if (!made) std::printf("NO NETWORK NAMESPACES: %s\n", why.c_str());
    return made;
  }
};

TEST_F(Hosts, LosingTheTabletIsAModeNotACrash) {
  const auto networks = Hosts::networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << "network namespaces are not permitted here";
  TwoHosts robot(*networks, "");
  ASSERT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(90))) << robot.story();

  // Fully cut while it drives.
  const auto errand = robot.command({"goto", "--pose", "4.5", "5.3", "1.5708"});
  ASSERT_TRUE(robot.wait_for([&] { return robot.speed() > 0.1; }, Seconds(30))) << robot.story();
  networks->set(kCut, kCut);
  bool lost_the_right = false;
  ASSERT_TRUE(robot.wait_for(
      [&] {
        lost_the_right = lost_the_right || !robot.granted();
        return !robot.guide_is_ok();
      },
      Seconds(10)))
      << robot.story();
  EXPECT_EQ(errand->wait(std::chrono::seconds(120)), 0) << errand->output() << robot.story();
  EXPECT_FALSE(lost_the_right) << "the drive chain on the nuc goes on";
  EXPECT_TRUE(robot.granted()) << robot.story();
  EXPECT_TRUE(robot.wait_for([&] { return robot.speed() < 0.01; }, Seconds(10))) << "it parks";
  const auto status = robot.command({"status"});
  EXPECT_EQ(status->wait(), 1) << "and says so";
  EXPECT_NE(status->output().find("guide"), std::string::npos) << status->output();

  networks->set(kGood, kGood);
  const auto restored = std::chrono::steady_clock::now();
  ASSERT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(20))) << robot.story();
  const Seconds back = std::chrono::steady_clock::now() - restored;
  std::printf("the second host is back %.2f s after the link\n", back.count());
  EXPECT_LT(back.count(), 3.0 * slowdown());

  // One way: the nuc hears the tablet, but not the other way round; then the reverse.
  networks->set(kCut, kGood);
  std::this_thread::sleep_for(milliseconds(3000));
  EXPECT_TRUE(robot.granted()) << robot.story();
  networks->set(kGood, kCut);
  ASSERT_TRUE(robot.wait_for([&] { return !robot.guide_is_ok(); }, Seconds(10)));
  EXPECT_TRUE(robot.granted()) << robot.story();
  networks->set(kGood, kGood);
  ASSERT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(20))) << robot.story();
}

TEST_F(Hosts, ABadLinkDoesNotReachTheDriveChain) {
  const auto networks = Hosts::networks(TwoNetworks::Kind::kOneSubnet);
  if (!networks) GTEST_SKIP() << "network namespaces are not permitted here";
  TwoHosts robot(*networks, "");
  ASSERT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(90))) << robot.story();
  const Line bad{.loss = 0.1, .delay = milliseconds(30), .jitter = milliseconds(40)};
  networks->set(bad, bad);
  bool lost_the_right = false;
  const auto errand = robot.command({"goto", "--pose", "4.5", "5.3", "1.5708"});
  robot.wait_for(
      [&] {
        lost_the_right = lost_the_right || !robot.granted();
        return errand->output().find("arrived") != std::string::npos;
      },
      Seconds(120));
  EXPECT_EQ(errand->wait(), 0) << errand->output() << errand->errors() << robot.story();
  EXPECT_FALSE(lost_the_right);
  EXPECT_TRUE(robot.wait_for([&] { return robot.guide_is_ok(); }, Seconds(10)))
      << "10 % loss, 30 to 70 ms, frames out of order: still there\n"
      << robot.story();
  EXPECT_GT(networks->frames(), 1000U) << "the link was used";
}

TEST_F(Hosts, MeetAcrossARouterByPeers) {
  const auto networks = Hosts::networks(TwoNetworks::Kind::kRouted);
  if (!networks) GTEST_SKIP() << "network namespaces are not permitted here";
  TwoHosts robot(*networks, "hosts:\n  nuc: {peers: [" + networks->address_of_b() +
                                "]}\n  tablet: {peers: [" + networks->address_of_a() + "]}\n");
  EXPECT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(90))) << robot.story();
}

TEST_F(Hosts, MeetAcrossARouterWithSecurity) {
  if (signing_robot_starves()) GTEST_SKIP() << kSigningRobotStarves;
  const auto networks = Hosts::networks(TwoNetworks::Kind::kRouted);
  if (!networks) GTEST_SKIP() << "network namespaces are not permitted here";
  TwoHosts robot(*networks,
                 "hosts:\n  nuc: {peers: [" + networks->address_of_b() + "]}\n  tablet: {peers: [" +
                     networks->address_of_a() + "]}\n",
                 true);
  EXPECT_TRUE(robot.wait_for([&] { return robot.all_is_well(); }, Seconds(240))) << robot.story();
}

}  // namespace
}  // namespace usher::test
