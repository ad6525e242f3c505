#include <gtest/gtest.h>

#include "drivers/lms100/device_real/component.hpp"
#include "foundation/geometry/angle.hpp"
#include "runtime/testing/test_host.hpp"
#include "scripted_scanner.hpp"

namespace usher::lms100 {
namespace {

using runtime::HealthState;
using std::chrono::milliseconds;
constexpr const char* kMount = "robot.laser.mount_x: 0.1 m\nrobot.laser.mount_z: 0.3 m";

/// The scripted scanner at the end of the line: turns 50 times a second once it was asked to.
class Device final : public runtime::LockstepDevice {
 public:
  void opened() override { asked_for_scans = false; }
  runtime::Bytes answer(std::span<const std::uint8_t> bytes) override {
    const auto said = scanner.answer(Bytes(bytes.begin(), bytes.end()));
    asked_for_scans =
        asked_for_scans || scanner.heard.back().find("LMDscandata") != std::string::npos;
    return said;
  }
  runtime::Bytes speak(runtime::Time /*now*/) override {
    if (!asked_for_scans || silent || ++asked % 2 != 0) return {};
    ++counter;
    runtime::Bytes said = scanner.scan(counter, static_cast<std::uint32_t>(counter) * 20000U);
    if (damaged) said.resize(said.size() / 2);
    return said;
  }

  Scanner scanner{Dialect::kBinary};
  bool asked_for_scans = false, silent = false, damaged = false;
  int asked = 0;
  std::uint16_t counter = 0;
};

class DeviceReal : public testing::Test {
 protected:
  std::uint8_t health() const { return host.heartbeat().state(); }
  std::shared_ptr<Device> device = std::make_shared<Device>();
  runtime::TestHost host{runtime::component_factory<Lms100Component>("lms100"), kMount, device};
};

TEST_F(DeviceReal, ConfiguresTheScannerAndPublishesItsScans) {
  host.run_for(milliseconds(8000));
  const auto scan = host.last(topics::kScan);
  ASSERT_TRUE(scan) << host.heartbeat().reason();
  EXPECT_EQ(scan->header().frame_id(), "laser");
  ASSERT_EQ(scan->ranges().size(), 4U);
  EXPECT_FLOAT_EQ(scan->ranges()[0], 1.0F);
  EXPECT_NEAR(scan->angle_increment(), geometry::radians(0.5), 1e-6);
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  EXPECT_TRUE(host.last(topics::kTfStatic));
  host.clear();
  host.run_for(milliseconds(1000));
  EXPECT_NEAR(static_cast<double>(host.written(topics::kScan).size()), 50.0, 2.0);
}

TEST_F(DeviceReal, SaysThatItIsUnpluggedAndConfiguresAnew) {
  host.run_for(milliseconds(8000));
  device->plugged = false;
  host.run_for(milliseconds(200));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  host.clear();
  host.run_for(milliseconds(500));
  EXPECT_TRUE(host.written(topics::kScan).empty());
  const auto told = device->scanner.heard.size();
  device->plugged = true;
  host.run_for(milliseconds(8000));
  EXPECT_GT(device->scanner.heard.size(), told + 5) << "logged in and configured again";
  EXPECT_FALSE(host.written(topics::kScan).empty());
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
}

TEST_F(DeviceReal, NoticesASilentScannerAndHalfTelegrams) {
  host.run_for(milliseconds(8000));
  device->silent = true;
  host.run_for(milliseconds(500));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kDegraded));
  device->silent = false;
  host.run_for(milliseconds(8000));
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  device->damaged = true;
  host.run_for(milliseconds(1000));
  device->damaged = false;
  host.run_for(milliseconds(8000));
  EXPECT_GT(host.counter("bytes: skipped") + host.counter("telegrams: damaged"), 0U);
  EXPECT_EQ(health(), std::uint8_t(HealthState::kOk)) << host.heartbeat().reason();
  EXPECT_TRUE(host.running());
}

}  // namespace
}  // namespace usher::lms100
