#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>

#include "drivers/segway_rmp/core/emulated_base.hpp"
#include "drivers/segway_rmp/core/status.hpp"
#include "drivers/segway_rmp/device_real/component.hpp"
#include "support/right_to_drive.hpp"

namespace usher::segway_rmp {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::BaseStatus_Constants;
using testing::HasSubstr;
using Wish = EmulatedBase::Wish;

runtime::ComponentFactory driver() {
  return runtime::component_factory<SegwayRmpComponent>("segway_rmp");
}

/// A base that does at once what it is ordered.
class Device final : public runtime::LockstepDevice {
 public:
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    base_.received(bytes, [this](const EmulatedBase::Order& order) {
      if (order.wish == Wish::kDrive) twist = order.twist;
      if (order.wish == Wish::kShutdown) state_.mode = Mode::kStandby, twist = {}, ++shutdowns;
      if (order.wish == Wish::kBalance) state_.mode = Mode::kBalancing, ++balances;
    });
    return {};
  }
  runtime::Bytes speak(runtime::Time now) override {
    if (silent) return {};
    state_.stamp = now.time_since_epoch();
    state_.status_1 = warning;
    if (!hangs) {
      const double outer = 0.5 * Odometry::Parameters{}.track * twist.w;
      state_.left_velocity = twist.v - outer;
      state_.right_velocity = twist.v + outer;
    }
    state_.left_travel += 0.01 * twist.v;
    state_.right_travel += 0.01 * twist.v;
    const auto said = base_.feedback(state_);
    runtime::Bytes bytes{said.begin(), said.end()};
    if (damaged) bytes.at(10) ^= 1;
    return bytes;
  }

  void last_will(std::span<const std::uint8_t> message, runtime::Duration lasts) override {
    EmulatedBase guarded{Calibration{}};
    guarded.received(message, [&](const EmulatedBase::Order& order) {
      will = order.wish == Wish::kDrive ? order.twist : geometry::Twist2{9.0, 9.0};
    });
    will_lasts = lasts;
  }

  /// As it does while nobody hears it, until it stands.
  void roll_out(double way) {
    state_.left_travel += way;
    state_.right_travel += way;
    twist = {};
  }
  void switch_off() { state_.mode = Mode::kStandby, twist = {}; }

  geometry::Twist2 twist;  ///< last ordered
  geometry::Twist2 will;   ///< what the guard would order
  runtime::Duration will_lasts{};
  int shutdowns = 0, balances = 0;
  std::uint16_t warning = 0;  ///< in its status
  bool silent = false;
  bool damaged = false;  ///< one frame of each cycle
  bool hangs = false;    ///< what it measures

 private:
  EmulatedBase base_{Calibration{}};
  SegwayFeedback state_;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t state() const { return host.last(topics::kBaseStatus)->state(); }
  void request(std::uint8_t command, const char* client = "supervisor") {
    usher_msgs::msg::BaseRequest message;
    message.id(++id);
    message.command(command);
    host.publish(topics::kBaseRequest, message, client);
  }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{driver(), "", device};
  test::RightToDrive right{host};
  std::uint64_t id = 0;
};

TEST_F(DeviceReal, ConfiguresTheBaseAndDrivesWhatIsGranted) {
  right.v = 0.5;
  right.run(2000);
  EXPECT_EQ(state(), STATE_BALANCING) << host.heartbeat().reason();
  EXPECT_GE(device->balances, 1);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
  EXPECT_NEAR(host.last(topics::kOdom)->twist().twist().linear().x(), 0.5, 0.02);
  EXPECT_GT(host.last(topics::kOdom)->pose().pose().position().x(), 0.2);
}

/// What a base that counts as Segways do by default is ordered, and what odometry makes of that,
/// of 0.5 m/s and 0.4 rad/s.
std::pair<geometry::Twist2, geometry::Twist2> ordered_and_measured(const std::string& parameters) {
  const auto device = std::make_shared<Device>();
  runtime::TestHost host{driver(), parameters, device};
  test::RightToDrive right{host};
  right.v = 0.5;
  right.w = 0.4;
  right.run(2000);
  return {device->twist, wire::from_message(host.last(topics::kOdom)->twist().twist()).value()};
}

TEST(SegwayCalibration, ReachesWhatTheBaseIsOrderedAndWhatItThenMeasures) {
  const double speed_counts = Calibration{}.command_counts_per_speed;
  const double turn_counts = Calibration{}.command_counts_per_turn_rate;
  const struct {
    const char* parameters;
    geometry::Twist2 expected;
  } cases[] = {{"", {0.5, 0.4}},
               {"robot.segway.speed_counts: 350", {0.5 * 350 / speed_counts, 0.4}},
               {"robot.segway.turn_counts: 333", {0.5, 0.4 * 333 / turn_counts}},
               {"robot.segway.turn_reversed: true", {0.5, -0.4}}};
  for (const auto& [parameters, expected] : cases) {
    SCOPED_TRACE(parameters);
    const auto [ordered, measured] = ordered_and_measured(parameters);
    EXPECT_NEAR(ordered.v, expected.v, 0.003);
    EXPECT_NEAR(ordered.w, expected.w, 0.003);
    EXPECT_NEAR(measured.v, expected.v, 0.006);
    EXPECT_NEAR(measured.w, expected.w, 0.015);
  }
}

TEST(SegwayCalibration, RefusesWhatNoSegwayCounts) {
  const auto error = [](const char* parameters) {
    return runtime::TestHost::try_make(driver(), parameters).error();
  };
  EXPECT_THAT(error("robot.segway.turn_counts: 7.8"),
              HasSubstr("robot.segway.turn_counts must be in [250, 600], got 7.8"));
  EXPECT_THAT(error("robot.segway.turn_counts: -447"),
              HasSubstr("robot.segway.turn_counts must be in [250, 600], got -447"));
  EXPECT_THAT(error("robot.segway.speed_counts: 147"),
              HasSubstr("robot.segway.speed_counts must be in [300, 360], got 147"));
  EXPECT_THAT(error("robot.segway.turn_reversed: -1"),
              HasSubstr("robot.segway.turn_reversed must be true or false, got \"-1\""));
}

TEST_F(DeviceReal, StandsWhenCommandOrGrantFallSilent) {
  right.v = 0.5;
  right.run(2000);
  right.commands = false;
  right.run(160);
  EXPECT_EQ(device->twist.v, 0.0) << "no command";
  right.commands = true;
  right.run(200);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
  right.grants = false;
  right.run(160);
  EXPECT_EQ(device->twist.v, 0.0) << "no grant";
}

TEST_F(DeviceReal, ObeysNobodyElse) {
  right.v = 0.5;
  right.commander = "intruder";
  right.run(2000);
  EXPECT_EQ(device->twist.v, 0.0);
  EXPECT_GT(host.counter("commands: foreign writer"), 0U);
}

TEST_F(DeviceReal, IsDrivenOnlyUnderAGrantOfTheSupervisor) {
  right.v = 0.5;
  right.grantor = "intruder";
  right.run(2000);
  EXPECT_EQ(device->twist.v, 0.0);
  EXPECT_GT(host.counter("grants: foreign writer"), 0U);
  right.grantor = "supervisor";
  right.run(2000);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
}

TEST_F(DeviceReal, IsNotDrivenByWhoTookTheSupervisorsNameThoughTheSupervisorDies) {
  const auto impostor_drives = [&](int ms) {
    for (int at = 0; at < ms; at += 20) {
      usher_msgs::msg::DriveGrant grant;
      grant.stamp(wire::to_message(host.now()));
      grant.granted(true);
      grant.writer(host.world().writer_guid(topics::kDriveCommand, "intruder"));
      grant.epoch(2);
      grant.valid_for(0.12F);
      host.world().publish(topics::kDriveGrant, grant, "supervisor", "elsewhere");
      usher_msgs::msg::DriveCommand command;
      command.stamp(wire::to_message(host.now()));
      command.epoch(2);
      command.number(++id);
      command.v(0.8);
      host.publish(topics::kDriveCommand, command, "intruder");
      right.run(20);
      EXPECT_LT(device->twist.v, 0.6);
    }
  };
  right.v = 0.5;
  right.run(2000);
  impostor_drives(400);
  EXPECT_EQ(device->twist.v, 0.0) << "two speak in the supervisor's name";
  right.grants = right.commands = false;
  impostor_drives(1000);
  host.world().leave("supervisor");
  impostor_drives(1000);
}

TEST_F(DeviceReal, SaysThatTheBaseIsGoneAndReturnsByItself) {
  right.v = 0.5;
  right.run(2000);
  device->plugged = false;
  right.run(200);
  EXPECT_EQ(state(), STATE_DISCONNECTED);
  EXPECT_EQ(host.last(topics::kBaseStatus)->v(), 0.0);
  device->plugged = true;
  right.run(3000);
  EXPECT_EQ(state(), STATE_BALANCING);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
  device->silent = true;
  right.run(1200);
  EXPECT_EQ(state(), STATE_DISCONNECTED) << "the line is open, the base says nothing";
  device->silent = false;
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING);
}

TEST_F(DeviceReal, ABaseThatWentOffWhileItsLineWasOutStaysOffOverARestart) {
  right.v = 0.5;
  right.run(2000);
  device->plugged = false;
  right.run(200);
  device->switch_off();
  const int balances = device->balances;
  device->plugged = true;
  right.run(3000);
  EXPECT_EQ(device->balances, balances);
  EXPECT_EQ(state(), STATE_EMERGENCY);
  host.world().kill(host.name());
  host.run_for(milliseconds(20));
  host.world().start(host.name());
  right.run(2000);
  EXPECT_EQ(device->balances, balances);
  EXPECT_EQ(state(), STATE_EMERGENCY);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_RESET);
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING);
}

TEST_F(DeviceReal, ABaseThatWentOffWhileNoDriverRanStaysOff) {
  right.v = 0.5;
  right.run(2000);
  device->plugged = false;
  right.run(200);
  host.world().kill(host.name());
  device->switch_off();
  const int balances = device->balances;
  host.run_for(milliseconds(20));
  device->plugged = true;
  host.world().start(host.name());
  right.run(2000);
  EXPECT_EQ(device->balances, balances);
  EXPECT_EQ(device->twist, geometry::Twist2{});
  EXPECT_EQ(state(), STATE_EMERGENCY);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_RESET);
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
}

TEST_F(DeviceReal, LeavesItsGuardTheArcOnWhichTheBaseRollsOut) {
  right.run(1000);
  EXPECT_EQ(device->will_lasts, runtime::Duration::zero()) << "it stands";
  right.v = 0.5;
  right.w = 0.4;
  right.run(2000);
  EXPECT_EQ(device->will.v, 0.0);
  EXPECT_NEAR(device->will.w, 0.4, 0.01);
  EXPECT_GE(device->will_lasts, milliseconds(500));
  EXPECT_LE(device->will_lasts, milliseconds(1000));
  right.w = -0.4;
  right.run(1000);
  EXPECT_NEAR(device->will.w, -0.4, 0.01);
  right.w = 0.0;
  right.run(1000);
  EXPECT_EQ(device->will_lasts, runtime::Duration::zero()) << "straight on it needs none";
  right.w = 0.4;
  right.run(1000);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  right.run(100);
  EXPECT_EQ(device->will_lasts, runtime::Duration::zero()) << "without motors it keeps no arc";
}

TEST_F(DeviceReal, ADriverWhoseMemoryCannotBeReadTouchesNoBase) {
  right.run(2000);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  right.run(200);
  ASSERT_EQ(state(), STATE_EMERGENCY);
  host.world().kill(host.name());
  const int balances = device->balances;
  for (const auto& [key, bytes] : host.world().kept(host.name()))
    host.world().unreadable(host.name()).insert(key);
  host.world().start(host.name());
  right.run(2000);
  EXPECT_FALSE(host.running());
  EXPECT_EQ(device->balances, balances);
}

TEST_F(DeviceReal, ADriverThatRestartsDrivesOnABaseThatStillBalances) {
  right.v = 0.5;
  right.run(2000);
  host.world().kill(host.name());
  host.run_for(milliseconds(20));
  device->twist = {};
  host.world().start(host.name());
  right.run(600);
  EXPECT_EQ(state(), STATE_BALANCING);
  EXPECT_NEAR(device->twist.v, 0.5, 0.01);
}

TEST_F(DeviceReal, ADriverThatRestartsGoesOnWithItsOdometry) {
  const auto x = [&] { return host.last(topics::kOdom)->pose().pose().position().x(); };
  right.v = 0.5;
  right.run(3000);
  right.v = 0.0;
  right.run(1000);
  const double before = x();
  ASSERT_GT(before, 0.5);
  host.world().kill(host.name());
  host.run_for(milliseconds(20));
  host.world().start(host.name());
  right.run(1000);
  EXPECT_NEAR(x(), before, 0.03);
  right.v = 0.5;
  right.run(2000);
  const double moving = x();
  EXPECT_GT(moving, before + 0.3);
  host.world().kill(host.name());
  device->roll_out(0.4);
  host.run_for(milliseconds(20));
  right.v = 0.0;
  host.world().start(host.name());
  right.run(1000);
  EXPECT_NEAR(x(), moving + 0.4, 0.03) << "it rolled on";
}

TEST_F(DeviceReal, CountsWhatItsLineSpoils) {
  right.run(2000);
  EXPECT_EQ(host.counter("packets: damaged"), 0U);
  device->damaged = true;
  right.run(100);
  EXPECT_GT(host.counter("packets: damaged"), 0U);
  EXPECT_GT(host.counter("bytes: skipped"), 0U);
  EXPECT_GT(host.counter("cycles: incomplete"), 0U);
  EXPECT_EQ(host.counter("odometers: jumped"), 0U);
}

TEST_F(DeviceReal, TellsWhatTheBaseSaysOfItself) {
  right.run(2000);
  EXPECT_EQ(host.heartbeat().reason(), "");
  device->warning = kLowBatteryHazard;
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING);
  EXPECT_EQ(host.heartbeat().reason(), "low battery hazard");
  device->warning = 0;
  right.run(500);
  device->silent = true;
  right.run(500);
  device->silent = false;
  right.run(2000);
  EXPECT_EQ(state(), STATE_BALANCING);
  EXPECT_EQ(host.heartbeat().reason(), "") << "it is heard again, as it was before";
  device->warning = kSafetyShutdown1;
  device->switch_off();
  right.run(1000);
  EXPECT_EQ(host.heartbeat().reason(), "the base does not balance: safety shutdown 1");
}

TEST_F(DeviceReal, OnlyTheSupervisorSwitchesItsMotors) {
  right.run(2000);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP, "stranger");
  right.run(200);
  EXPECT_EQ(device->shutdowns, 0);
  EXPECT_EQ(state(), STATE_BALANCING);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  right.run(200);
  const int balances = device->balances;
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_RESET, "stranger");
  right.run(200);
  EXPECT_EQ(device->balances, balances);
  EXPECT_EQ(state(), STATE_EMERGENCY);
}

TEST_F(DeviceReal, IsToldNoTurnRateWhileItsMotorsAreOff) {
  right.v = 0.8;
  right.w = 0.3;
  right.run(2000);
  device->hangs = true;
  right.grants = right.commands = false;
  right.run(200);
  EXPECT_EQ(device->twist.v, 0.0);
  EXPECT_NEAR(device->twist.w, 0.3, 0.02) << "it rolls out on its arc";
  right.grants = right.commands = true;
  right.run(200);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  right.grants = right.commands = false;
  right.run(200);
  EXPECT_EQ(device->twist, geometry::Twist2{});
}

TEST_F(DeviceReal, RemembersAnEmergencyStopOverARestart) {
  right.run(2000);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_EMERGENCY_STOP);
  right.run(200);
  EXPECT_GT(device->shutdowns, 0);
  EXPECT_EQ(state(), STATE_EMERGENCY);
  host.world().kill(host.name());
  host.run_for(milliseconds(20));
  const int balances = device->balances;
  host.world().start(host.name());
  right.run(2000);
  EXPECT_EQ(device->balances, balances) << "a new driver does not balance it again";
  EXPECT_EQ(state(), STATE_EMERGENCY);
  request(usher_msgs::msg::BaseRequest_Constants::COMMAND_RESET);
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING);
}

}  // namespace
}  // namespace usher::segway_rmp
