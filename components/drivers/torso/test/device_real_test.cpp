#include "drivers/torso/device_real/component.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/serial_frame/core/emulated_board.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"

namespace usher::torso {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
constexpr const char* kTorso =
    "robot.torso.torso_tilt: [-20 deg, 20 deg]\nrobot.torso.head_rise: [0, 0.1]\n"
    "robot.torso.turn_rate: 0.5 rad/s\nrobot.torso.rise_rate: 0.05 m/s";
constexpr std::size_t kTilt = 2, kRise = 3;

/// The board: greets, then says twenty times a second where its joints are, which is where it was
/// told last.
class Device final : public runtime::LockstepDevice {
 public:
  void opened() override { board_.hello_requests = 0; }
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    return board_.hear(bytes, [this](std::span<const std::uint8_t> content) {
      const auto frame = parse_command(content);
      if (!frame) return;
      largest_step =
          std::max(largest_step, std::abs(frame->joints[kTilt] - state.frame.joints[kTilt]));
      state.frame = *frame;
    });
  }
  runtime::Bytes speak(runtime::Time /*now*/) override {
    runtime::Bytes said;
    if (board_.hello_requests > 0 && !silent && ++asked_ % 5 == 0)
      board_.append(said, to_frame({board_.sequence++, state}));
    return said;
  }

  State state;
  bool silent = false;
  double largest_step = 0.0;

 private:
  serial_frame::EmulatedBoard board_{{1, {1, 0, 0}, 42, {7, 2}}};
  int asked_ = 0;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t health() const { return host.heartbeat().state(); }
  void want(double tilt, double rise, int ms) {
    usher_msgs::msg::TorsoFrame frame;
    frame.joints()[kTilt] = tilt;
    frame.joints()[kRise] = rise;
    frame.left_eye({0.0F, 1.0F, 0.0F});
    for (int i = 0; i < ms; i += 50) {
      frame.header(wire::header(host.now(), ""));
      host.publish(topics::kTorsoFrame, frame);
      host.run_for(milliseconds(50));
    }
  }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{runtime::component_factory<TorsoComponent>("torso"), kTorso, device};
};

TEST_F(DeviceReal, PosesTheTorsoWithinLimitsAndRatesAndSaysWhereItIs) {
  host.run_for(milliseconds(3000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  want(9.0, 0.06, 2000);
  EXPECT_NEAR(device->state.frame.joints[kTilt], 0.349, 1e-3) << "its limit";
  EXPECT_NEAR(device->state.frame.joints[kRise], 0.06, 1e-3);
  EXPECT_LE(device->largest_step, 0.5 * 0.05 + 2e-4);
  EXPECT_EQ(device->state.frame.left_eye, (kinematics::EyeColor{0, 1, 0}));
  const auto status = host.last(topics::kTorsoStatus);
  ASSERT_TRUE(status);
  EXPECT_NEAR(status->joints()[kTilt], 0.349, 1e-3);
  EXPECT_TRUE(status->moves());
  EXPECT_EQ(status->reason(), "");
}

TEST_F(DeviceReal, HoldsAndDimsWhenNobodySaysWhatToShow) {
  host.run_for(milliseconds(3000));
  want(0.3, 0.0, 400);
  const double there = device->state.frame.joints[kTilt];
  EXPECT_LT(there, 0.25) << "on its way";
  host.run_for(milliseconds(2000));
  EXPECT_LE(device->state.frame.joints[kTilt], 0.3 + 1e-4);
  const double held = device->state.frame.joints[kTilt];
  EXPECT_NEAR(device->state.frame.left_eye[1], 0.15, 0.01);
  host.run_for(milliseconds(1000));
  EXPECT_EQ(device->state.frame.joints[kTilt], held);
}

TEST_F(DeviceReal, MovesNothingForNonsense) {
  host.run_for(milliseconds(3000));
  want(0.1, 0.0, 1000);
  want(std::numeric_limits<double>::quiet_NaN(), 0.05, 1000);
  EXPECT_NEAR(device->state.frame.joints[kTilt], 0.1, 1e-3);
  EXPECT_NEAR(device->state.frame.joints[kRise], 0.0, 1e-3);
  EXPECT_GT(host.counter("frames: rejected"), 0U);
}

TEST_F(DeviceReal, NoticesASilentBoardAndStartsFromWhereItIsAfterwards) {
  host.run_for(milliseconds(3000));
  want(0.3, 0.0, 2000);
  device->silent = true;
  want(0.3, 0.0, 500);
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  EXPECT_EQ(host.heartbeat().reason(), "no word from the board");
  device->state.frame.joints[kTilt] = -0.3;  // somebody pushed it
  device->largest_step = 0.0;
  device->silent = false;
  want(0.3, 0.0, 3000);
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  EXPECT_NEAR(device->state.frame.joints[kTilt], 0.3, 1e-3);
  EXPECT_LE(device->largest_step, 0.5 * 0.05 + 2e-4) << "no jerk";
}

TEST_F(DeviceReal, StartsFromWhereTheJointsAreWhenItsServosComeBack) {
  host.run_for(milliseconds(3000));
  want(0.3, 0.0, 2000);
  device->state.status = kServosOff;
  want(0.3, 0.0, 500);
  device->state.frame.joints[kTilt] = -0.3;  // it sagged
  want(0.3, 0.0, 300);
  device->largest_step = 0.0;
  device->state.status = 0;
  want(0.3, 0.0, 3000);
  EXPECT_NEAR(device->state.frame.joints[kTilt], 0.3, 1e-3);
  EXPECT_LE(device->largest_step, 0.5 * 0.05 + 2e-4) << "no jerk";
}

TEST_F(DeviceReal, NoticesABoardThatIsUnpluggedAndTellsItsTroubles) {
  host.run_for(milliseconds(3000));
  device->state.status = kServosOff;
  host.run_for(milliseconds(300));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  EXPECT_FALSE(host.last(topics::kTorsoStatus)->moves());
  EXPECT_EQ(host.last(topics::kTorsoStatus)->reason(), "servos off");
  device->state.status = 0;
  device->plugged = false;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->plugged = true;
  host.run_for(milliseconds(6000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
}

}  // namespace
}  // namespace usher::torso
