#include <gtest/gtest.h>

#include <string>

#include "drivers/urg04lx/core/scip.hpp"
#include "drivers/urg04lx/device_real/component.hpp"
#include "runtime/testing/test_host.hpp"

namespace usher::urg04lx {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
constexpr const char* kMount = "robot.laser.mount_x: 0.1 m\nrobot.laser.mount_z: 0.3 m";

std::string encoded(std::uint32_t value, int characters) {
  std::string text;
  for (int i = characters - 1; i >= 0; --i)
    text.push_back(static_cast<char>((value >> (6 * i) & 0x3F) + 0x30));
  return text;
}

/// A scanner as the specification has it: one answer for each command, then ten scans a second.
class Device final : public runtime::LockstepDevice {
 public:
  void opened() override { streams = false; }
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    std::string said;
    heard.append(bytes.begin(), bytes.end());
    for (auto end = heard.find('\n'); end != std::string::npos; end = heard.find('\n')) {
      const std::string command = heard.substr(0, end);
      heard.erase(0, end + 1);
      if (command == "QT") streams = false, said += "QT\n00P\n\n";
      if (command == "SCIP2.0") said += "SCIP2.0\n0Ee\n\n";
      if (command == "PP") {
        said +=
            "PP\n00P\nMODL:URG-04LX(Hokuyo Automatic Co.,Ltd.);N\nDMIN:20;4\nDMAX:5600;_\n"
            "ARES:1024;\\\nAMIN:44;7\nAMAX:725;o\nAFRT:384;6\nSCAN:600;e\n\n";
      }
      if (command.starts_with("MD")) streams = true, said += command + "\n00P\n\n";
    }
    return {said.begin(), said.end()};
  }
  runtime::Bytes speak(runtime::Time /*now*/) override {
    if (!streams || silent || ++asked % 10 != 0) return {};
    time += 100;
    std::string data;
    // No turn is like the one before.
    for (int i = 0; i < 682; ++i) data += encoded(i == 0 ? 1400 + time / 100 % 2 : 1500, 3);
    const std::string stamp = encoded(time, 4);
    std::string text = "MD0044072501000\n99b\n" + stamp + checksum(stamp) + "\n";
    for (std::size_t at = 0; at < data.size(); at += 64) {
      const std::string line = data.substr(at, 64);
      text += line + checksum(line) + "\n";
    }
    text += "\n";
    if (damaged) text[100] ^= 1;
    return {text.begin(), text.end()};
  }

  bool streams = false, silent = false, damaged = false;

 private:
  std::string heard;
  int asked = 0;
  std::uint32_t time = 0;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t health() const { return host.heartbeat().state(); }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{runtime::component_factory<Urg04lxComponent>("urg04lx"), kMount, device};
};

TEST_F(DeviceReal, StartsTheScannerAndPublishesItsScans) {
  host.run_for(milliseconds(3000));
  const auto scan = host.last(topics::kScan);
  ASSERT_TRUE(scan) << host.heartbeat().reason();
  ASSERT_EQ(scan->ranges().size(), 682U);
  EXPECT_FLOAT_EQ(scan->ranges()[341], 1.5F);
  EXPECT_TRUE(scan->intensities().empty());
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  host.clear();
  host.run_for(milliseconds(1000));
  EXPECT_NEAR(static_cast<double>(host.written(topics::kScan).size()), 10.0, 1.0);
}

TEST_F(DeviceReal, SaysThatItIsUnpluggedAndStartsAnew) {
  host.run_for(milliseconds(3000));
  device->plugged = false;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->plugged = true;
  host.clear();
  host.run_for(milliseconds(4000));
  EXPECT_FALSE(host.written(topics::kScan).empty());
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
}

TEST_F(DeviceReal, NoticesASilentScannerAndCountsDamagedScans) {
  host.run_for(milliseconds(3000));
  device->silent = true;
  host.run_for(milliseconds(1000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->silent = false;
  host.run_for(milliseconds(4000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  const auto scans = host.written(topics::kScan).size();
  device->damaged = true;
  host.run_for(milliseconds(250));
  device->damaged = false;
  EXPECT_EQ(host.written(topics::kScan).size(), scans);
  host.run_for(milliseconds(500));
  EXPECT_GE(host.counter("answers: rejected"), 1U);
}

}  // namespace
}  // namespace usher::urg04lx
