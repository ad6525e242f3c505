#include <gtest/gtest.h>

#include <cmath>

#include "drivers/sensor_board/device_sim/component.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::sensor_board {
namespace {

using std::chrono::milliseconds;
constexpr const char* kRing =
    "robot.ultrasonic.mount_x: 0.2 m\nrobot.ultrasonic.mount_z: 0.1 m\n"
    "robot.ultrasonic.spacing: 22.5 deg";

TEST(DeviceSim, MeasuresAtTheRateOfARealBoardAndTellsItsWhiskersAtOnce) {
  runtime::TestHost host{runtime::component_factory<SensorBoardSimComponent>("sensor_board_sim"),
                         kRing};
  for (int i = 0; i < 100; ++i) {
    usher_sim_msgs::msg::SensorBoardReading reading;
    reading.header(wire::header(host.now(), "base_link"));
    reading.ranges({1.0F, 1.0F, 1.0F, 1.0F, 1.0F});
    host.publish(topics::kSimSensorBoard, reading);
    host.run_for(milliseconds(20));
  }
  EXPECT_NEAR(static_cast<double>(host.written(topics::kUltrasonic).size()), 40.0, 1.0);
  EXPECT_NEAR(static_cast<double>(host.written(topics::kKinectTilt).size()), 40.0, 1.0);
  EXPECT_NEAR(static_cast<double>(host.written(topics::kWhiskers).size()), 100.0, 1.0);
  EXPECT_FLOAT_EQ(host.last(topics::kUltrasonic)->scan_time(), 0.05F);
}

TEST(DeviceSim, BelievesNoEchoAlone) {
  runtime::TestHost host{runtime::component_factory<SensorBoardSimComponent>("sensor_board_sim"),
                         kRing};
  for (int i = 0; i < 100; ++i) {
    usher_sim_msgs::msg::SensorBoardReading reading;
    reading.header(wire::header(host.now(), "base_link"));
    reading.ranges({2.0F, 2.0F, i == 50 ? 0.9F : 2.0F, 2.0F, 2.0F});  // it is measured
    host.publish(topics::kSimSensorBoard, reading);
    host.run_for(milliseconds(20));
  }
  for (const auto& scan : host.written(topics::kUltrasonic))
    EXPECT_FLOAT_EQ(scan.ranges()[2], 2.2F);
}

TEST(DeviceSim, SaysWhichSensorDoesNotAnswer) {
  runtime::TestHost host{runtime::component_factory<SensorBoardSimComponent>("sensor_board_sim"),
                         kRing};
  const auto reason_after = [&host](int readings, float first) {
    for (int i = 0; i < readings; ++i) {
      usher_sim_msgs::msg::SensorBoardReading reading;
      reading.header(wire::header(host.now(), "base_link"));
      reading.ranges({first, 2.0F, 2.0F, 2.0F, 2.0F});
      host.publish(topics::kSimSensorBoard, reading);
      host.run_for(milliseconds(20));
    }
    return host.heartbeat().reason();
  };
  EXPECT_EQ(reason_after(40, std::nanf("")), "");
  EXPECT_EQ(reason_after(25, std::nanf("")), "ultrasonic sensor 1 does not answer");
  EXPECT_EQ(reason_after(10, HUGE_VALF), "") << "no echo is an answer";
}

}  // namespace
}  // namespace usher::sensor_board
