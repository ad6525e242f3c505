#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/sensor_board/device_real/component.hpp"
#include "drivers/serial_frame/core/emulated_board.hpp"
#include "foundation/geometry/angle.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::sensor_board {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
constexpr const char* kRing =
    "robot.ultrasonic.mount_x: 0.2 m\nrobot.ultrasonic.mount_z: 0.1 m\n"
    "robot.ultrasonic.spacing: 22.5 deg";

/// The board: greets, then says twenty times a second what its sensors see and where its servo is.
class Device final : public runtime::LockstepDevice {
 public:
  Device() { sensors.ranges_mm.fill(2000); }
  void opened() override { board_.hello_requests = 0; }
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    return board_.hear(bytes, [this](std::span<const std::uint8_t> content) {
      if (content[0] == 0x20)
        sensors.tilt = static_cast<std::int16_t>(content[2] | (content[3] << 8));
    });
  }
  runtime::Bytes speak(runtime::Time /*now*/) override {
    runtime::Bytes said;
    if (board_.hello_requests > 0 && !silent && ++asked_ % 5 == 0)
      board_.append(said, to_frame({board_.sequence++, sensors}));
    if (pressed != 0) {
      board_.append(said, to_frame({board_.sequence++, WhiskerChange{1, pressed, pressed}}));
      pressed = 0;
    }
    return said;
  }

  Sensors sensors;
  bool silent = false;
  std::uint8_t pressed = 0;  ///< switches that change with the next word

 private:
  serial_frame::EmulatedBoard board_{{1, {1, 0, 0}, 42, {5, 8}}};
  int asked_ = 0;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t health() const { return host.heartbeat().state(); }
  void tilt(double servo) {
    usher_msgs::msg::CameraTilt command;
    command.header(wire::header(host.now(), "base_link"));
    command.servo(servo);
    host.publish(topics::kKinectTiltCommand, command);
    host.run_for(milliseconds(300));
  }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{runtime::component_factory<SensorBoardComponent>("sensor_board"), kRing,
                         device};
};

TEST_F(DeviceReal, PublishesRangesAndWhiskers) {
  host.run_for(milliseconds(4000));
  const auto scan = host.last(topics::kUltrasonic);
  ASSERT_TRUE(scan) << host.heartbeat().reason();
  ASSERT_EQ(scan->ranges().size(), 5U);
  EXPECT_FLOAT_EQ(scan->ranges()[2], 2.2F) << "from the middle of the ring";
  EXPECT_FALSE(host.last(topics::kWhiskers)->front_left());
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  device->sensors.whisker_mask = 0x01;
  host.run_for(milliseconds(100));
  EXPECT_TRUE(host.last(topics::kWhiskers)->front_left());
}

TEST_F(DeviceReal, PublishesRangesAndTiltOfEveryMeasurement) {
  host.run_for(milliseconds(4000));
  host.clear();
  host.run_for(milliseconds(2000));
  EXPECT_NEAR(static_cast<double>(host.written(topics::kUltrasonic).size()), 40.0, 1.0);
  EXPECT_NEAR(static_cast<double>(host.written(topics::kKinectTilt).size()), 40.0, 1.0);
  EXPECT_FLOAT_EQ(host.last(topics::kUltrasonic)->scan_time(), 0.05F);
}

TEST_F(DeviceReal, BelievesNoEchoAlone) {
  host.run_for(milliseconds(4000));
  host.clear();
  device->sensors.ranges_mm[2] = 900;
  host.run_for(milliseconds(50));
  device->sensors.ranges_mm[2] = 2000;
  host.run_for(milliseconds(500));
  EXPECT_GT(host.written(topics::kUltrasonic).size(), 9U);
  for (const auto& scan : host.written(topics::kUltrasonic))
    EXPECT_FLOAT_EQ(scan.ranges()[2], 2.2F);
}

TEST_F(DeviceReal, ItsRangesAreAsOldAsTheMiddleMeasurement) {
  host.run_for(milliseconds(4000));
  const auto time_of = [](const auto& message) {
    return wire::from_message(message.header().stamp());
  };
  EXPECT_EQ(time_of(*host.last(topics::kKinectTilt)) - time_of(*host.last(topics::kUltrasonic)),
            milliseconds(50));
}

TEST_F(DeviceReal, WhatIsNearerThanASensorMeasuresIsARange) {
  device->sensors.ranges_mm.fill(152);  // what it says of all that is nearer
  host.run_for(milliseconds(4000));
  const auto scan = host.last(topics::kUltrasonic);
  ASSERT_TRUE(scan);
  EXPECT_GE(scan->ranges()[2], scan->range_min());
}

TEST_F(DeviceReal, SaysWhatTroublesTheBoard) {
  host.run_for(milliseconds(4000));
  device->sensors.status = kSonarBusFault | kSupplyLow;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  EXPECT_EQ(host.heartbeat().reason(), "supply low, ultrasonic bus fault");
  device->sensors.status = 0;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
}

TEST_F(DeviceReal, SaysWhichSensorDoesNotAnswer) {
  host.run_for(milliseconds(4000));
  device->sensors.ranges_mm[2] = 0;
  host.run_for(milliseconds(800));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  host.run_for(milliseconds(500));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  EXPECT_EQ(host.heartbeat().reason(), "ultrasonic sensor 3 does not answer");
  EXPECT_TRUE(std::isnan(host.last(topics::kUltrasonic)->ranges()[2]));
  EXPECT_FLOAT_EQ(host.last(topics::kUltrasonic)->ranges()[1], 2.2F);
  device->sensors.ranges_mm[2] = 0xFFFF;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
}

TEST_F(DeviceReal, PublishesNoRangesOfAWhisker) {
  host.run_for(milliseconds(4000));
  host.clear();
  device->silent = true;
  device->pressed = 0x04;
  host.run_for(milliseconds(100));
  ASSERT_EQ(host.written(topics::kWhiskers).size(), 1U);
  EXPECT_TRUE(host.last(topics::kWhiskers)->front_right());
  EXPECT_TRUE(host.written(topics::kUltrasonic).empty());
  EXPECT_TRUE(host.written(topics::kKinectTilt).empty());
}

TEST_F(DeviceReal, TurnsTheCameraWhereItIsTold) {
  host.run_for(milliseconds(4000));
  tilt(geometry::radians(-10.0));
  EXPECT_EQ(device->sensors.tilt, -100);
  EXPECT_NEAR(host.last(topics::kKinectTilt)->servo(), geometry::radians(-10.0), 1e-3);
  tilt(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(device->sensors.tilt, -100) << "nonsense moves nothing";
  EXPECT_EQ(host.counter("tilt commands: rejected"), 1U);
  tilt(1.0);
  EXPECT_EQ(device->sensors.tilt, 200) << "clipped to what the servo can";
}

TEST_F(DeviceReal, NoticesASilentBoardAndOneThatIsUnplugged) {
  host.run_for(milliseconds(4000));
  tilt(0.1);
  device->silent = true;
  host.run_for(milliseconds(500));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->silent = false;
  host.run_for(milliseconds(500));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  device->plugged = false;
  host.run_for(milliseconds(100));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->sensors.tilt = 0;  // it was without power
  device->plugged = true;
  host.run_for(milliseconds(6000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  EXPECT_EQ(device->sensors.tilt, 57) << "the tilt is set again";
}

}  // namespace
}  // namespace usher::sensor_board
