#include "localization/amcl/shell/component.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "runtime/testing/test_host.hpp"
#include "sim_robot.hpp"
#include "wire/conversions.hpp"
#include "wire/frames.hpp"

namespace usher::amcl {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using namespace usher_msgs::msg::LocalizationStatus_Constants;

/// A robot that stands in the small building; everything that it says can be left out.
class Component : public testing::Test {
 protected:
  Component() {
    geometry::Pose3 mount;
    tf2_msgs::msg::TFMessage fixed;
    fixed.transforms().push_back(
        wire::transform(host.now(), frames::kBaseFootprint, "laser", mount));
    host.publish(topics::kTfStatic, fixed);
  }
  void give_map(const grid::OccupancyGrid& given) {
    host.publish(topics::kMap, wire::to_message(host.now(), frames::kMap, given));
    host.run_for(milliseconds(5));
  }
  sensor_msgs::msg::LaserScan scan() const {
    sensor_msgs::msg::LaserScan message;
    message.header(wire::header(host.now(), "laser"));
    constexpr int kBeams = 181;
    const double increment = 2.0 * geometry::kPi / kBeams;
    message.angle_min(0.0F);
    message.angle_increment(static_cast<float>(increment));
    message.angle_max(static_cast<float>(increment * (kBeams - 1)));
    message.range_min(0.1F);
    message.range_max(20.0F);
    for (int i = 0; i < kBeams; ++i)
      message.ranges().push_back(static_cast<float>(range(stands.yaw + increment * i)));
    return message;
  }
  /// Walks along the beam: slow, and surely right.
  double range(double angle) const {
    for (int step = 0; step < 2000; ++step) {
      const double r = 0.01 * step;
      const auto cell =
          map.geometry().cell_at(stands.x + r * std::cos(angle), stands.y + r * std::sin(angle));
      if (map.value_or(cell, grid::kFree) == grid::kOccupied) return r;
    }
    return std::numeric_limits<double>::infinity();
  }
  void run(int ms, bool scans = true, bool odometry = true) {
    for (int at = 0; at < ms; at += 100) {
      if (odometry) {
        tf2_msgs::msg::TFMessage moving;
        moving.transforms().push_back(
            wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint, {}));
        host.publish(topics::kTf, moving);
      }
      if (scans) host.publish(topics::kScanFiltered, scan());
      host.run_for(milliseconds(100));
    }
  }
  /// Tells it where it stands.
  void tell_pose() {
    geometry_msgs::msg::PoseWithCovarianceStamped hint;
    hint.header(wire::header(host.now(), frames::kMap));
    hint.pose().pose(wire::to_message(stands));
    hint.pose().covariance(wire::to_covariance(Eigen::Vector3d(0.04, 0.04, 0.02).asDiagonal()));
    host.publish(topics::kInitialPose, hint);
  }
  usher_msgs::msg::LocalizationStatus status() const {
    return host.last(topics::kLocalizationStatus).value();
  }

  grid::OccupancyGrid map = small_building();
  geometry::Pose2 stands{0.5, 5.0, 0.3};
  runtime::TestHost host{runtime::component_factory<AmclComponent>("amcl"),
                         "site.initial_pose: [0.5, 5.0, 0.3]"};
};

TEST_F(Component, KnowsWhereItStands) {
  give_map(map);
  run(2000);
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
  ASSERT_TRUE(host.last(topics::kAmclPose));
  const auto pose = wire::to_planar(host.last(topics::kAmclPose)->pose().pose());
  ASSERT_TRUE(pose);
  EXPECT_LT(geometry::distance(*pose, stands), 0.1);
}

TEST_F(Component, IsLostWithoutScansAndBackWithThem) {
  give_map(map);
  run(2000);
  run(700, false);
  EXPECT_EQ(status().state(), STATE_LOST);
  EXPECT_EQ(status().reason(), "no scan");
  run(500);
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
}

/// As a base that rolls out while its odometry cannot be used.
TEST_F(Component, IsLostUntilAScanFitsWhereItBelievesToBeAfterAGap) {
  give_map(map);
  stands = {6.0, 1.0, 0.0};  // in a room, where a scan fits one place
  tell_pose();
  run(2000);
  ASSERT_EQ(status().state(), STATE_GOOD) << status().reason();
  run(1500, false, false);
  stands = {6.7, 1.5, 0.3};
  host.clear();
  run(3000);
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
  const auto pose = wire::to_planar(host.last(topics::kAmclPose)->pose().pose());
  ASSERT_TRUE(pose);
  EXPECT_LT(geometry::distance(*pose, stands), 0.1) << "no odometry told it that it moved";
  for (const auto& each : host.written(topics::kLocalizationStatus)) {
    if (each.state() == STATE_GOOD) break;
    EXPECT_EQ(each.state(), STATE_LOST) << each.reason();
  }
}

TEST_F(Component, TellsTheFrameOfTheMapUntilTheNextScanWhateverItsRate) {
  give_map(map);
  run(2000);
  const auto told = host.written(topics::kTf);
  ASSERT_GT(told.size(), 10U);
  const auto until = [](const auto& message) {
    return wire::from_message(message.transforms().at(0).header().stamp());
  };
  EXPECT_GE(until(told.back()), host.now() + milliseconds(20)) << "scans come each 100 ms";
  EXPECT_LE(until(told.back()), host.now() + milliseconds(100));
  run(400, false);
  run(200);  // after a gap it is told for longer, and never backward
  const auto after = host.written(topics::kTf);
  for (std::size_t i = 1; i < after.size(); ++i) EXPECT_GT(until(after[i]), until(after[i - 1]));
}

TEST_F(Component, DropsAndCountsScansWhosePlaceIsNotKnown) {
  give_map(map);
  run(1500, true, false);
  EXPECT_EQ(status().state(), STATE_LOST);
  EXPECT_EQ(status().reason(), "no scan that can be used");
  EXPECT_GE(host.counter("tf: dropped"), 10U);
}

TEST_F(Component, AgesScansOfAnotherHostFromTheirArrival) {
  give_map(map);
  run(2000);
  for (int at = 0; at < 20; ++at) {  // its clock is behind, by more than a scan may be old
    tf2_msgs::msg::TFMessage moving;
    moving.transforms().push_back(
        wire::transform(host.now(), frames::kOdom, frames::kBaseFootprint, {}));
    host.publish(topics::kTf, moving);
    auto late = scan();
    late.header().stamp(wire::to_message(host.now() - milliseconds(700)));
    host.world().publish(topics::kScanFiltered, late, "scan_filter", "sensing");
    host.run_for(milliseconds(100));
  }
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
  // As do those who read its status on this host.
  const auto age = host.now() - wire::from_message(status().header().stamp());
  EXPECT_GE(age, milliseconds(0));
  EXPECT_LT(age, milliseconds(250));
  run(700, false);
  EXPECT_EQ(status().state(), STATE_LOST);
}

TEST_F(Component, SaysThatThereIsNoMap) {
  run(1000);
  EXPECT_EQ(status().state(), STATE_LOST);
  EXPECT_THAT(status().reason(), HasSubstr("no map"));
  EXPECT_FALSE(host.last(topics::kAmclPose));
  give_map(map);
  run(2000);
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
}

TEST_F(Component, RejectsAndCountsNonsenseAndKeepsItsBelief) {
  give_map(map);
  run(2000);
  auto nonsense = scan();
  nonsense.angle_increment(std::numeric_limits<float>::quiet_NaN());
  host.publish(topics::kScanFiltered, nonsense);
  nonsense = scan();
  nonsense.ranges().clear();
  host.publish(topics::kScanFiltered, nonsense);
  auto no_map = wire::to_message(host.now(), frames::kMap, map);
  no_map.info().resolution(-1.0F);
  host.publish(topics::kMap, no_map);
  geometry_msgs::msg::PoseWithCovarianceStamped no_pose;
  no_pose.header(wire::header(host.now(), frames::kMap));
  no_pose.pose().pose().position().x(std::numeric_limits<double>::quiet_NaN());
  host.publish(topics::kInitialPose, no_pose);
  run(1000);
  EXPECT_GE(host.counter("scan: rejected"), 1U);
  EXPECT_EQ(host.counter("map: rejected"), 1U);
  EXPECT_EQ(host.counter("initialpose: rejected"), 1U);
  EXPECT_EQ(status().state(), STATE_GOOD) << status().reason();
}

TEST_F(Component, TakesUpItsPoseAfterARestart) {
  give_map(map);
  stands = {3.0, 5.1, 0.0};  // not where the site starts it
  tell_pose();
  run(3000);
  ASSERT_EQ(status().state(), STATE_GOOD) << status().reason();
  host.world().kill(host.name());
  host.run_for(milliseconds(10));
  host.clear();
  host.world().start(host.name());
  run(2000);
  ASSERT_TRUE(host.last(topics::kAmclPose));
  const auto pose = wire::to_planar(host.last(topics::kAmclPose)->pose().pose());
  ASSERT_TRUE(pose);
  EXPECT_LT(geometry::distance(*pose, stands), 0.1);
  EXPECT_EQ(host.counter("pose: not taken up"), 0U);
}

TEST_F(Component, RefusesAPoseThatWasKeptOnAnotherMap) {
  give_map(map);
  run(3000);
  ASSERT_EQ(status().state(), STATE_GOOD) << status().reason();
  host.world().kill(host.name());
  host.run_for(milliseconds(10));
  host.clear();
  map.at({200, 50}) = map.at({200, 50}) == grid::kFree ? grid::kOccupied : grid::kFree;
  give_map(map);
  host.world().start(host.name());
  run(300);
  EXPECT_EQ(host.counter("pose: not taken up"), 1U);
  bool told = false;
  for (const auto& each : host.written(topics::kLocalizationStatus))
    told = told || each.reason().find("it was kept on another map") != std::string::npos;
  EXPECT_TRUE(told);
}

}  // namespace
}  // namespace usher::amcl
