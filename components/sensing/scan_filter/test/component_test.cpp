#include "sensing/scan_filter/shell/component.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "foundation/geometry/angle.hpp"
#include "runtime/testing/test_host.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::scan_filter {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;
using namespace usher_msgs::msg::BaseStatus_Constants;

constexpr const char* kRobot = R"(robot.laser.mount_x: 0.28 m
robot.laser.mount_z: 0.065 m
robot.laser.self_filter: 2.0 rad
robot.wheel_radius: 0.235 m
robot.ultrasonic.mount_z: 0.12 m)";

/// MARVIN on an open floor with a wall 2 m around the laser: 100 statuses, 50 scans and 20
/// ultrasonic scans a second, each of which can be left out.
class Component : public testing::Test {
 protected:
  sensor_msgs::msg::LaserScan scan() const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now() + scans_ahead, "laser"));
    message.angle_min(static_cast<float>(geometry::radians(-135)));
    message.angle_increment(static_cast<float>(geometry::radians(0.5)));
    message.angle_max(static_cast<float>(geometry::radians(135)));
    message.time_increment(time_increment);
    message.range_min(0.05F);
    message.range_max(20.0F);
    message.ranges().assign(541, range);
    return message;
  }
  sensor_msgs::msg::LaserScan sonar() const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now(), "ultrasonic"));
    message.angle_min(-1.0F);
    message.angle_increment(0.5F);
    message.angle_max(1.0F);
    message.range_min(0.3F);
    message.range_max(6.0F);
    message.ranges().assign(5, 2.0F);
    return message;
  }
  usher_msgs::msg::BaseStatus status() const {
    usher_msgs::msg::BaseStatus message;
    message.header(wire::header(host.now() + status_ahead, frames::kBaseLink));
    message.state(state);
    message.pitch(pitch);
    return message;
  }
  void run(int ms) {
    for (int at = 0; at < ms; at += 10) {
      if (statuses) host.publish(topics::kBaseStatus, status());
      if (scans && at % 20 == 0)
        host.world().publish(topics::kScan, scan(), "laser", scanners_host);
      if (sonars && at % 50 == 0) host.publish(topics::kUltrasonic, sonar());
      host.run_for(milliseconds(10));
    }
  }
  std::size_t left() const { return host.written(topics::kScanFiltered).size(); }
  std::string reason() const { return host.heartbeat().reason(); }

  runtime::TestHost host{runtime::component_factory<ScanFilterComponent>("scan_filter"), kRobot};
  bool statuses = true, scans = true, sonars = true;
  milliseconds status_ahead{0}, scans_ahead{0};
  std::string scanners_host;
  std::uint8_t state = STATE_BALANCING;
  double pitch = 0.0;
  float range = 2.0F, time_increment = 0.0F;
};

TEST_F(Component, PublishesEachScanWithItsStampOnThePlane) {
  run(500);
  EXPECT_EQ(left(), 25U);
  EXPECT_EQ(host.written(topics::kUltrasonicFiltered).size(), 10U);
  EXPECT_EQ(reason(), "");
  host.clear();
  pitch = geometry::radians(-8.0);
  run(40);
  const auto sent = host.now() - milliseconds(20);
  const auto planar = host.last(topics::kScanFiltered).value();
  EXPECT_EQ(wire::from_message(planar.header().stamp()), sent);
  EXPECT_EQ(planar.header().frame_id(), "laser_level");
  // Straight ahead: equation 4.7 and the mount's own way.
  const auto ahead =
      static_cast<std::size_t>(std::lround(-planar.angle_min() / planar.angle_increment()));
  const double mount = 0.28 * std::cos(pitch) + 0.065 * std::sin(pitch) - 0.28;
  EXPECT_NEAR(planar.ranges()[ahead], 2.0 * std::cos(pitch) + mount, 1e-3);
}

TEST_F(Component, SaysThatThereIsNoScan) {
  run(500);
  scans = false;
  run(300);
  EXPECT_EQ(reason(), "no scan");
  host.clear();
  scans = true;
  run(100);
  EXPECT_EQ(reason(), "");
  EXPECT_EQ(left(), 5U);
}

TEST_F(Component, LateScansAreNone) {
  run(500);
  EXPECT_EQ(reason(), "");
  scans_ahead = milliseconds(-600);
  run(100);
  host.clear();
  run(1000);
  EXPECT_EQ(reason(), "no scan");
  EXPECT_EQ(left(), 0U);
  scans_ahead = milliseconds(0);
  run(300);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, PublishesNothingWithoutPitch) {
  run(500);
  statuses = false;
  run(40);
  host.clear();
  run(200);
  EXPECT_EQ(left(), 0U);
  EXPECT_EQ(reason(), "no pitch");
  statuses = true;
  run(100);
  EXPECT_EQ(reason(), "");
  EXPECT_GE(left(), 4U);
}

TEST_F(Component, ADisconnectedBaseHasNoPitch) {
  run(500);
  state = STATE_DISCONNECTED;
  run(40);
  host.clear();
  run(200);
  EXPECT_EQ(left(), 0U);
  EXPECT_EQ(reason(), "no pitch: the base is disconnected");
}

TEST_F(Component, AStatusFromTheFutureIsRefused) {
  run(500);
  status_ahead = milliseconds(5000);
  run(10);
  status_ahead = {};
  host.clear();
  run(500);
  EXPECT_EQ(left(), 25U) << "it does not make the later ones old";
  EXPECT_EQ(host.counter("base/status: refused"), 1U);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, SaysWhyEveryStatusIsRefused) {
  run(500);
  status_ahead = milliseconds(5000);
  run(50);
  EXPECT_EQ(reason(), "") << "one lost status is none";
  host.clear();
  run(200);
  EXPECT_EQ(left(), 0U);
  EXPECT_THAT(reason(), HasSubstr("at most 20 ms ahead of now, got 49"));
  EXPECT_GE(host.counter("base/status: refused"), 20U);
  status_ahead = {};
  pitch = std::numeric_limits<double>::quiet_NaN();
  run(200);
  EXPECT_THAT(reason(), StartsWith("no pitch: pitch must be within 1.5 rad"));
}

TEST_F(Component, WaitsForThePitchOfTheScan) {
  run(500);
  host.clear();
  scans_ahead = milliseconds(35);  // the base's status is that late
  run(20);
  EXPECT_EQ(left(), 0U);
  host.publish(topics::kBaseStatus, status());
  host.run_for(milliseconds(1));
  EXPECT_EQ(left(), 1U) << "with the pitch that reaches its time";
}

TEST_F(Component, CorrectsEachBeamWithThePitchOfItsOwnTime) {
  sonars = scans = false;
  const auto range_ahead = [&](float increment) {
    time_increment = increment;
    pitch = 0.0;
    run(100);
    pitch = geometry::radians(-10.0);
    run(10);
    scans_ahead = milliseconds(-20);  // begun when the body stood upright, ended when it leant
    host.clear();
    host.publish(topics::kScan, scan());
    host.run_for(milliseconds(1));
    const auto planar = host.last(topics::kScanFiltered).value();
    return planar.ranges()[static_cast<std::size_t>(
        std::lround(-planar.angle_min() / planar.angle_increment()))];
  };
  EXPECT_NEAR(range_ahead(0.0F), 2.0F, 1e-5F);
  const double half = geometry::radians(-5.0);  // within the turn
  EXPECT_NEAR(range_ahead(10e-3F / 540.0F),
              2.0 * std::cos(half) + 0.28 * std::cos(half) + 0.065 * std::sin(half) - 0.28, 0.01);
}

TEST_F(Component, RefusesScansThatTakeTooLong) {
  run(500);
  for (const float increment : {std::numeric_limits<float>::quiet_NaN(), -1e-5F, 1.0F}) {
    time_increment = increment;
    host.publish(topics::kScan, scan());
    host.run_for(milliseconds(1));
  }
  time_increment = 0.0F;
  run(120);
  EXPECT_EQ(host.counter("scans: rejected"), 3U);
  EXPECT_EQ(reason(), "") << "the others are good";
  host.clear();
  for (const float increment : {1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    time_increment = increment;
    run(200);
    EXPECT_EQ(left(), 0U);
    EXPECT_THAT(reason(), StartsWith("scan refused: the scan must take 0 to 0.2 s, got "));
  }
  time_increment = 0.0F;
  run(120);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, SaysThatScansAndPitchDoNotMeet) {
  run(500);
  scans_ahead = milliseconds(-2000);
  scanners_host = "sensing";  // which has another time
  host.clear();
  run(300);
  EXPECT_EQ(left(), 0U);
  EXPECT_THAT(reason(), HasSubstr("scan without pitch: the pitch is remembered only for"));
  EXPECT_GE(host.counter("scans: without pitch"), 13U);
  scans_ahead = {};
  run(100);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, RefusesABlindLaser) {
  run(500);
  host.clear();
  range = std::numeric_limits<float>::infinity();
  run(200);
  EXPECT_EQ(left(), 0U);
  EXPECT_THAT(reason(), HasSubstr("the sensor is blind"));
  EXPECT_GE(host.counter("scans: rejected"), 5U);
  range = 2.0F;
  run(120);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, RejectsAndCountsNonsense) {
  run(500);
  auto nonsense = scan();
  nonsense.angle_increment(std::numeric_limits<float>::quiet_NaN());
  host.publish(topics::kScan, nonsense);
  nonsense = scan();
  nonsense.ranges().clear();
  host.publish(topics::kScan, nonsense);
  run(200);
  EXPECT_EQ(host.counter("scans: rejected"), 2U);
  EXPECT_EQ(reason(), "") << "the others are good";
  scans = false;
  for (int i = 0; i < 10; ++i) {
    nonsense.header(wire::header(host.now(), "laser"));
    host.publish(topics::kScan, nonsense);
    run(20);
  }
  EXPECT_EQ(reason(), "scan refused: scan must have 1..100000 ranges, got 0");
  scans = true;
  run(120);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, AnUltrasonicScanThatMakesNoSenseSaysNothingOfTheLaser) {
  run(500);
  auto nonsense = sonar();
  nonsense.ranges().clear();
  host.publish(topics::kUltrasonic, nonsense);
  scans = sonars = false;  // no good one that would clear it
  run(150);
  EXPECT_EQ(host.counter("scans: rejected"), 1U);
  EXPECT_EQ(reason(), "");
}

TEST_F(Component, GoesOnWithoutTheUltrasonicSensors) {
  sonars = false;
  run(1000);
  EXPECT_EQ(reason(), "");
  EXPECT_EQ(left(), 50U);
  EXPECT_TRUE(host.written(topics::kUltrasonicFiltered).empty());
}

TEST_F(Component, PlacesTheFramesOfItsScans) {
  run(100);
  const auto frames = host.last(topics::kTfStatic).value();
  ASSERT_EQ(frames.transforms().size(), 2U);
  EXPECT_EQ(frames.transforms()[0].child_frame_id(), "laser_level");
  EXPECT_DOUBLE_EQ(frames.transforms()[0].transform().translation().x(), 0.28);
  EXPECT_EQ(frames.transforms()[1].child_frame_id(), "ultrasonic_level");
}

}  // namespace
}  // namespace usher::scan_filter
