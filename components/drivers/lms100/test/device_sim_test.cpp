#include <gtest/gtest.h>

#include <vector>

#include "drivers/lms100/device_sim/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::lms100 {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

TEST(DeviceSim, PassesScansOnAndSaysWhenTheyEnd) {
  runtime::TestHost host(runtime::component_factory<Lms100SimComponent>("lms100_sim"),
                         "robot.laser.mount_x: 0.1 m\nrobot.laser.mount_z: 0.3 m");
  sensor_msgs::msg::LaserScan scan;
  scan.angle_min(-1.0F);
  scan.angle_increment(0.5F);
  scan.ranges({1.0F, 2.0F, 3.0F});
  for (int i = 0; i < 25; ++i) {
    scan.header(wire::header(host.now(), "laser"));
    host.publish(topics::kSimScan, scan);
    host.run_for(milliseconds(20));
  }
  ASSERT_EQ(host.written(topics::kScan).size(), 25U);
  const auto last = host.last(topics::kScan);
  EXPECT_EQ(last->ranges(), scan.ranges());
  EXPECT_FLOAT_EQ(last->angle_max(), 0.0F);
  EXPECT_FLOAT_EQ(last->range_max(), 20.0F);
  EXPECT_EQ(host.heartbeat().state(), std::uint8_t(HealthState::kOk));
  host.run_for(milliseconds(400));
  EXPECT_EQ(host.heartbeat().state(), std::uint8_t(HealthState::kDegraded));
  EXPECT_EQ(host.heartbeat().reason(), "the scanner is silent");
  EXPECT_EQ(host.written(topics::kScan).size(), 25U);
}

TEST(DeviceSim, KeepsBackTheScansOfAScannerThatRepeatsItself) {
  runtime::TestHost host(runtime::component_factory<Lms100SimComponent>("lms100_sim"),
                         "robot.laser.mount_x: 0.1 m\nrobot.laser.mount_z: 0.3 m");
  sensor_msgs::msg::LaserScan scan;
  scan.angle_min(-1.0F);
  scan.angle_increment(0.01F);
  scan.ranges(std::vector<float>(200, 2.0F));
  const auto run = [&](int scans, float step) {
    for (int i = 0; i < scans; ++i) {
      scan.header(wire::header(host.now(), "laser"));
      scan.ranges()[7] += step;
      host.publish(topics::kSimScan, scan);
      host.run_for(milliseconds(20));
    }
  };
  run(10, 0.001F);
  EXPECT_EQ(host.written(topics::kScan).size(), 10U) << "one beam differs: it lives";
  run(20, 0.0F);
  EXPECT_EQ(host.written(topics::kScan).size(), 13U);
  EXPECT_EQ(host.heartbeat().state(), std::uint8_t(HealthState::kDegraded));
  EXPECT_EQ(host.heartbeat().reason(), "the scanner repeats the same scan");
  run(10, 0.001F);
  EXPECT_EQ(host.written(topics::kScan).size(), 23U) << "back by itself";
  EXPECT_EQ(host.heartbeat().state(), std::uint8_t(HealthState::kOk));
}

}  // namespace
}  // namespace usher::lms100
