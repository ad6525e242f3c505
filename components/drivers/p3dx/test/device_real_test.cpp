#include <gtest/gtest.h>

#include <cmath>

#include "drivers/p3dx/device_real/component.hpp"
#include "support/right_to_drive.hpp"

namespace usher::p3dx {
namespace {

using std::chrono::milliseconds;
using namespace usher_msgs::msg::BaseStatus_Constants;
constexpr const char* kRing = "robot.ultrasonic.mount_x: 0.2 m\nrobot.ultrasonic.mount_z: 0.1 m";

/// The controller: echoes the handshake, then reports ten times a second and does what it is told.
/// A sonar fires every 40 ms.
class Device final : public runtime::LockstepDevice {
 public:
  void opened() override { running = motors = false; }
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    runtime::Bytes said;
    decoder_.feed(bytes, [&](std::span<const std::uint8_t> packet) {
      const auto command = packet[0];
      const int value = packet.size() < 4   ? 0
                        : packet[1] == 0x1B ? -(packet[2] | packet[3] << 8)
                                            : (packet[2] | packet[3] << 8);
      if (!running && command <= 2) {
        const Frame echo = encode(static_cast<Command>(command));
        said.insert(said.end(), echo.span().begin(), echo.span().end());
        running = command == 2;
      } else if (command == static_cast<std::uint8_t>(Command::kEnable)) {
        motors = value != 0;
      } else if (command == static_cast<std::uint8_t>(Command::kVelocity)) {
        velocity = value;
      } else if (command == static_cast<std::uint8_t>(Command::kEmergencyStop)) {
        velocity = 0;
        ++emergency_stops;
      }
    });
    return said;
  }
  runtime::Bytes speak(runtime::Time /*now*/) override {
    if (!running || silent || ++asked_ % 10 != 0) return {};
    x_ += velocity / 10;
    runtime::Bytes b = {0x32};
    const auto u16 = [&](int v) {
      b.push_back(static_cast<std::uint8_t>(v & 0xFF));
      b.push_back(static_cast<std::uint8_t>(v >> 8 & 0xFF));
    };
    for (const int v : {x_, 0, 0, velocity, velocity}) u16(v);
    b.push_back(120);
    for (const int v : {0, 0, motors ? 1 : 0}) u16(v);
    const int fired = asked_ / 4 - fired_;
    b.insert(b.end(), {0, static_cast<std::uint8_t>(deaf ? 0 : fired)});
    for (int i = 0; i < fired; ++i) {
      const auto number = static_cast<std::uint8_t>(fired_++ % 8);
      if (deaf) continue;
      b.push_back(number);
      u16(crossed > 0 ? 900 : 1500);
      --crossed;
    }
    for (int i = 0; i < 5; ++i) b.push_back(0);
    runtime::Bytes packet = {0xFA, 0xFB, static_cast<std::uint8_t>(b.size() + 2)};
    packet.insert(packet.end(), b.begin(), b.end());
    const std::uint16_t sum = checksum(b);
    packet.push_back(static_cast<std::uint8_t>(sum >> 8));
    packet.push_back(static_cast<std::uint8_t>(sum & 0xFF));
    return packet;
  }

  bool running = false, motors = false, silent = false;
  bool deaf = false;  ///< no sonar fires
  int crossed = 0;    ///< so many firings hear another robot's
  int velocity = 0;   ///< [mm/s] last ordered
  int emergency_stops = 0;

 private:
  Decoder decoder_;
  int asked_ = 0, x_ = 0, fired_ = 0;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t state() const { return host.last(topics::kBaseStatus)->state(); }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{runtime::component_factory<P3dxComponent>("p3dx"), kRing, device};
  test::RightToDrive right{host};
};

TEST_F(DeviceReal, WakesTheBaseAndDrivesWhatIsGranted) {
  right.v = 0.3;
  right.run(4000);
  EXPECT_TRUE(device->motors);
  EXPECT_EQ(device->velocity, 300);
  EXPECT_EQ(state(), STATE_BALANCING) << host.heartbeat().reason();
  EXPECT_GT(host.last(topics::kOdom)->pose().pose().position().x(), 0.3);
  const auto sonar = host.last(topics::kUltrasonic);
  ASSERT_TRUE(sonar);
  EXPECT_EQ(sonar->ranges().size(), kSonarSlots);
  host.clear();
  right.run(1000);
  EXPECT_NEAR(static_cast<double>(host.written(topics::kOdom).size()), 100.0, 5.0)
      << "ten reports a second are predicted to 100";
}

TEST_F(DeviceReal, ItsStatusIsAsOldAsTheReportThatItTells) {
  right.v = 0.3;
  right.run(4000);
  device->silent = true;
  right.run(20);
  const auto stamp = [this] {
    return wire::from_message(host.last(topics::kBaseStatus)->header().stamp());
  };
  const auto heard = stamp();
  host.clear();
  right.run(80);
  EXPECT_GT(host.written(topics::kBaseStatus).size(), 5U) << "it still tells what it obeys";
  EXPECT_EQ(stamp(), heard);
  EXPECT_GT(wire::from_message(host.last(topics::kOdom)->header().stamp()), heard)
      << "the pose is predicted";
}

TEST_F(DeviceReal, BelievesNoEchoAlone) {
  host.run_for(milliseconds(4000));
  host.clear();
  device->crossed = 8;  // each sonar once
  host.run_for(milliseconds(3200));
  EXPECT_LE(device->crossed, 0);
  int ranges = 0;
  for (const auto& scan : host.written(topics::kUltrasonic)) {
    for (const float range : scan.ranges()) {
      if (std::isnan(range)) continue;
      EXPECT_FLOAT_EQ(range, 1.7F) << "from the middle of the ring";
      ++ranges;
    }
  }
  EXPECT_NEAR(ranges, 80, 3) << "each firing is told once";
}

TEST_F(DeviceReal, ItsSonarsAreAsOldAsTheMiddleMeasurement) {
  host.run_for(milliseconds(4000));
  for (int i = 0; i < 200; ++i) {
    host.clear();
    host.run_for(milliseconds(10));
    for (const auto& scan : host.written(topics::kUltrasonic)) {
      const auto age = host.now() - wire::from_message(scan.header().stamp());
      EXPECT_GE(age, milliseconds(300)) << "fired before";
      EXPECT_LE(age, milliseconds(420)) << "costs take none older than 500 ms";
    }
  }
}

TEST_F(DeviceReal, TellsNothingOfSonarsThatDoNotFire) {
  host.run_for(milliseconds(4000));
  device->deaf = true;
  host.run_for(milliseconds(100));
  host.clear();
  host.run_for(milliseconds(500));
  EXPECT_TRUE(host.written(topics::kUltrasonic).empty());
}

TEST_F(DeviceReal, StandsWhenCommandOrGrantFallSilent) {
  right.v = 0.3;
  right.run(4000);
  right.commands = false;
  right.run(220);
  EXPECT_EQ(device->velocity, 0) << "no command";
  right.commands = true;
  right.run(300);
  EXPECT_EQ(device->velocity, 300);
  right.grants = false;
  right.run(220);
  EXPECT_EQ(device->velocity, 0) << "no grant";
}

TEST_F(DeviceReal, SaysThatTheBaseIsGoneAndWakesItAnew) {
  right.v = 0.3;
  right.run(4000);
  device->plugged = false;
  right.run(200);
  EXPECT_EQ(state(), STATE_DISCONNECTED);
  device->plugged = true;
  right.run(5000);
  EXPECT_EQ(state(), STATE_BALANCING) << host.heartbeat().reason();
  EXPECT_EQ(device->velocity, 300);
  device->silent = true;
  right.run(1500);
  EXPECT_EQ(state(), STATE_DISCONNECTED) << "the line is open, the base says nothing";
}

TEST_F(DeviceReal, AnEmergencyStopTakesTheMotorsOffAndHoldsOverARestart) {
  auto request = [this, id = 0U](std::uint8_t command) mutable {
    usher_msgs::msg::BaseRequest message;
    message.id(++id);
    message.command(command);
    host.publish(topics::kBaseRequest, message, "supervisor");
  };
  using namespace usher_msgs::msg::BaseRequest_Constants;
  right.v = 0.3;
  right.run(4000);
  request(COMMAND_EMERGENCY_STOP);
  right.run(300);
  EXPECT_GT(device->emergency_stops, 0);
  EXPECT_EQ(state(), STATE_EMERGENCY);
  EXPECT_FALSE(device->motors);
  host.world().kill(host.name());
  host.world().start(host.name());
  right.run(4000);
  EXPECT_EQ(state(), STATE_EMERGENCY);
  EXPECT_FALSE(device->motors);
  request(COMMAND_RESET);
  right.run(1000);
  EXPECT_EQ(state(), STATE_BALANCING) << host.heartbeat().reason();
  EXPECT_EQ(device->velocity, 300);
}

}  // namespace
}  // namespace usher::p3dx
