// Scans, odometry and maps that are not what they should be, written to the whole simulated robot
// while it drives: counted in a heartbeat, nobody crashes, and a robot that gets nothing else
// stops.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "operations/command_line/installation.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The robot of the demo, on its way to the lounge.
class BadInput : public testing::Test {
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

sensor_msgs::msg::LaserScan scan(std::size_t beams, float range, float increment) {
  sensor_msgs::msg::LaserScan message;
  message.header().frame_id("laser");
  message.angle_min(-2.3562F);
  message.angle_max(2.3562F);
  message.angle_increment(increment);
  message.range_min(0.05F);
  message.range_max(20.0F);
  message.ranges(std::vector<float>(beams, range));
  return message;
}

nav_msgs::msg::Odometry odometry(double x, double v) {
  nav_msgs::msg::Odometry message;
  message.header().frame_id("odom");
  message.child_frame_id("base_footprint");
  message.pose().pose().position().x(x);
  message.pose().pose().orientation().w(1.0);
  message.twist().twist().linear().x(v);
  return message;
}

nav_msgs::msg::OccupancyGrid map(std::uint32_t width, std::uint32_t height, float resolution,
                                 std::size_t cells) {
  nav_msgs::msg::OccupancyGrid message;
  message.header().frame_id("map");
  message.info().width(width);
  message.info().height(height);
  message.info().resolution(resolution);
  message.info().origin().orientation().w(1.0);
  message.data(std::vector<std::int8_t>(cells, 0));
  return message;
}

TEST_F(BadInput, ScansAreCountedAndTheRobotStandsWhenThereAreNoOthers) {
  const sensor_msgs::msg::LaserScan bad[] = {scan(0, 1.0F, 0.0087F), scan(541, 1.0F, 0.0F),
                                             scan(541, 1.0F, kNan), scan(1'000'000, 1.0F, 0.0087F),
                                             scan(3, 1.0F, -1e30F)};
  std::size_t next = 0;
  // The driver still lives for the supervisor; only its scans are gone.
  run_->world().at(run_->world().now(), [this] { run_->world().hang("lms100", seconds(4)); });
  flood(seconds(4), [&] {
    run_->world().publish(topics::kScan, bad[next++ % std::size(bad)]);
    run_->world().publish_bytes(topics::kScan, {0, 1, 0, 0, 7, 7}, "other");
  });
  EXPECT_LT(std::abs(speed()), 0.1);
  EXPECT_GE(count("scan_filter", "scans: rejected"), 150U) << run_->complaints();
  EXPECT_GE(count("scan_filter", "scan: rejected"), 150U) << run_->complaints();
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, ABlindLaserStopsTheRobot) {
  const float blind[] = {kNan, 0.0F, std::numeric_limits<float>::infinity()};
  std::size_t next = 0;
  run_->world().at(run_->world().now(), [this] { run_->world().hang("lms100", seconds(4)); });
  flood(seconds(4), [&] {
    auto message = scan(541, blind[next++ % std::size(blind)], 0.00873F);
    message.header().stamp(wire::to_message(run_->world().now()));
    run_->world().publish(topics::kScan, message);
  });
  EXPECT_LT(std::abs(speed()), 0.1);
  EXPECT_GE(count("scan_filter", "scans: rejected"), 150U) << run_->complaints();
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, OdometryIsCountedByAllWhoReadIt) {
  nav_msgs::msg::Odometry bad[] = {odometry(std::nan(""), 0.5), odometry(0.0, std::nan("")),
                                   odometry(0.0, -1e300)};
  std::size_t next = 0;
  auto& world = run_->world();
  // Each good one is followed by a bad one at once, so that the bad one is the newest.
  world.observe(topics::kOdom, [&](const auto& message, const auto& info) {
    if (world.participant_of(info.writer) != "segway_rmp") return;
    auto& worse = bad[next++ % std::size(bad)];
    worse.header().stamp(message.header().stamp());
    world.publish(topics::kOdom, worse);
    world.publish_bytes(topics::kOdom, {0, 1, 0, 0, 1, 2, 3, 4, 5}, "other");
  });
  world.run_for(seconds(3));
  for (const char* reader : {"local_planner", "navigator"}) {
    EXPECT_GE(count(reader, "odom: rejected"), 200U) << reader << "\n" << run_->complaints();
    EXPECT_GE(count(reader, "inputs: rejected"), 10U) << reader << "\n" << run_->complaints();
  }
  EXPECT_LT(std::abs(speed()), 0.1) << "nothing tells it how fast it is";
  EXPECT_LT(run_->record().summary().localization_max, 0.2) << "tf is as good as before";
  EXPECT_EQ(run_->record().summary().contacts, 0U);
  EXPECT_EQ(faults_, 0);
}

TEST_F(BadInput, MapsAreCountedAndTheGoodOneStays) {
  const nav_msgs::msg::OccupancyGrid bad[] = {
      map(0, 0, 0.05F, 0), map(100, 100, kNan, 10'000), map(65'535, 65'535, 0.05F, 3),
      map(100, 100, 0.05F, 9'999), map(100, 100, -1.0F, 10'000)};
  std::size_t next = 0;
  flood(seconds(3), [&] {
    run_->world().publish(topics::kMap, bad[next++ % std::size(bad)]);
    run_->world().publish_bytes(topics::kMap, {0, 1, 0, 0}, "other");
  });
  for (const char* reader : {"amcl", "costmap"})
    EXPECT_GE(count(reader, "map: rejected"), 100U) << reader << "\n" << run_->complaints();
  EXPECT_EQ(faults_, 0);
  EXPECT_LT(run_->record().summary().localization_max, 0.2);
  EXPECT_EQ(run_->record().summary().contacts, 0U);
}

}  // namespace
}  // namespace usher::operations
