#include <gtest/gtest.h>

#include <limits>

#include "drivers/torso/device_sim/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::torso {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;

/// A simulated torso that is at once where it is told.
struct Bench {
  runtime::TestHost host{runtime::component_factory<TorsoSimComponent>("torso_sim"),
                         "robot.torso.head_shake: [-0.8, 0.8]\nrobot.torso.turn_rate: 1.0"};
  usher_sim_msgs::msg::TorsoReading reading;

  void run(int ms, bool speaks = true, double want = 0.5) {
    usher_msgs::msg::TorsoFrame frame;
    frame.joints()[6] = want;
    for (int i = 0; i < ms; i += 20) {
      frame.header(wire::header(host.now(), ""));
      host.publish(topics::kTorsoFrame, frame);
      reading.header(wire::header(host.now(), ""));
      if (const auto told = host.last(topics::kSimTorsoCommand)) reading.joints(told->joints());
      if (speaks) host.publish(topics::kSimTorso, reading);
      host.run_for(milliseconds(20));
    }
  }
};

TEST(DeviceSim, PosesTheSimulatedTorso) {
  Bench bench;
  bench.run(200);
  EXPECT_LT(bench.host.last(topics::kSimTorsoCommand)->joints()[6], 0.3);
  bench.run(1000);
  EXPECT_DOUBLE_EQ(bench.host.last(topics::kSimTorsoCommand)->joints()[6], 0.5);
  EXPECT_DOUBLE_EQ(bench.host.last(topics::kTorsoStatus)->joints()[6], 0.5);
  EXPECT_EQ(bench.host.heartbeat().state(), std::uint8_t(HealthState::kOk));
}

TEST(DeviceSim, SaysNothingToATorsoThatIsSilentOrNowhere) {
  Bench bench;
  bench.run(1000);
  bench.run(400, false);
  EXPECT_EQ(bench.host.heartbeat().state(), std::uint8_t(HealthState::kDegraded));
  bench.host.clear();
  bench.run(400, false);
  EXPECT_TRUE(bench.host.written(topics::kSimTorsoCommand).empty());
  EXPECT_TRUE(bench.host.written(topics::kTorsoStatus).empty());
  bench.reading.joints()[0] = std::numeric_limits<double>::quiet_NaN();
  bench.run(400);
  EXPECT_TRUE(bench.host.written(topics::kTorsoStatus).empty());
  EXPECT_GT(bench.host.counter("readings: rejected"), 0U);
}

}  // namespace
}  // namespace usher::torso
