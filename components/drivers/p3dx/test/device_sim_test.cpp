#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "drivers/p3dx/device_sim/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::p3dx {
namespace {

using std::chrono::milliseconds;
constexpr const char* kRing = "robot.ultrasonic.mount_x: 0.2 m\nrobot.ultrasonic.mount_z: 0.1 m";

TEST(DeviceSim, BelievesNoEchoAlone) {
  runtime::TestHost host{runtime::component_factory<P3dxSimComponent>("p3dx_sim"), kRing};
  for (int ms = 0; ms < 6400; ms += 20) {
    usher_sim_msgs::msg::SensorBoardReading board;
    board.header(wire::header(host.now(), "base_link"));
    const bool crossed = ms >= 3200 && ms < 3240;  // once
    board.ranges().assign(kSonarSlots, crossed ? 0.9F : 1.5F);
    host.publish(topics::kSimSensorBoard, board);
    usher_sim_msgs::msg::BaseFeedback feedback;
    feedback.header(wire::header(host.now(), "base_link"));
    feedback.balancing(true);
    host.publish(topics::kSimBaseFeedback, feedback);
    host.run_for(milliseconds(20));
  }
  std::array<int, kSonarSlots> fired{};
  for (const auto& scan : host.written(topics::kUltrasonic)) {
    for (std::size_t slot = 0; slot < kSonarSlots; ++slot) {
      if (std::isnan(scan.ranges()[slot])) continue;
      EXPECT_FLOAT_EQ(scan.ranges()[slot], 1.7F);
      ++fired[slot];
    }
  }
  for (std::size_t slot = 0; slot < kSonarSlots; ++slot)
    EXPECT_NEAR(fired[slot], is_sonar(slot) ? 160 : 0, 1) << slot;
}

}  // namespace
}  // namespace usher::p3dx
