#include "wire/conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "foundation/random/random.hpp"

namespace usher::wire {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Time, KeepsNanosecondsAndNegativeTimes) {
  for (const std::int64_t ns :
       {0LL, 1LL, 999'999'999LL, 1'700'000'000'250'000'000LL, -500'000'000LL, -1LL}) {
    const Time time{runtime::Duration(ns)};
    EXPECT_EQ(from_message(to_message(time)), time) << ns;
  }
  EXPECT_EQ(to_message(Time(runtime::Duration(-500'000'000))).sec(), -1);
}

TEST(Pose, SurvivesTheRoundTrip) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const geometry::Pose2 pose{random.uniform(-100, 100), random.uniform(-100, 100),
                               random.uniform(-3.1, 3.1)};
    const auto back = to_planar(to_message(pose));
    ASSERT_TRUE(back);
    EXPECT_NEAR(back->x, pose.x, 1e-12);
    EXPECT_NEAR(back->y, pose.y, 1e-12);
    EXPECT_NEAR(back->yaw, pose.yaw, 1e-9);
  }
}

TEST(Pose, WithoutARotationIsRefused) {
  geometry_msgs::msg::Pose pose;
  pose.orientation().w(0.0);
  EXPECT_FALSE(to_planar(pose));
  pose = to_message(geometry::Pose2{});
  pose.position().x(kNaN);
  EXPECT_FALSE(to_planar(pose));
}

TEST(Path, SurvivesAndNamesTheBadPose) {
  const std::vector<geometry::Pose2> path = {{0, 0, 0}, {1, 0, 0.1}, {2, 0.1, 0.2}};
  auto message = to_message(Time{}, "map", path);
  const auto back = from_message(message);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->size(), 3U);
  message.poses()[1].pose().position().y(std::numeric_limits<double>::infinity());
  const auto bad = from_message(message);
  ASSERT_FALSE(bad);
  EXPECT_NE(bad.error().find("pose 1"), std::string::npos);
}

TEST(OccupancyGrid, SurvivesTheRoundTripWithItsResolution) {
  grid::OccupancyGrid grid({3, 2, 0.05, -1.5, 2.0}, grid::kUnknown);
  grid.at({1, 1}) = grid::kOccupied;
  const auto back = from_message(to_message(Time{}, "map", grid));
  ASSERT_TRUE(back) << back.error();
  EXPECT_EQ(*back, grid);
}

TEST(OccupancyGrid, RefusesSizesAndValuesThatDoNotFit) {
  const auto good = to_message(Time{}, "map", grid::OccupancyGrid({3, 2, 0.05, 0, 0}));
  auto bad = good;
  bad.info().width(4);
  EXPECT_FALSE(from_message(bad));
  bad = good;
  bad.info().width(0xFFFFFFFF);
  bad.info().height(0xFFFFFFFF);
  EXPECT_FALSE(from_message(bad));
  bad = good;
  bad.data()[0] = 101;
  EXPECT_FALSE(from_message(bad));
  bad = good;
  bad.info().resolution(0.0F);
  EXPECT_FALSE(from_message(bad));
  bad = good;
  bad.info().origin(to_message(geometry::Pose2{0, 0, 0.5}));
  EXPECT_FALSE(from_message(bad));
  EXPECT_FALSE(from_message(nav_msgs::msg::OccupancyGrid()));
}

TEST(Costmap, SurvivesAndRefusesTruncation) {
  grid::Grid<std::uint8_t> costs({4, 4, 0.05, 1.0, 2.0}, 7);
  auto message = to_message(Time{}, "odom", costs);
  const auto back = from_message(message);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, costs);
  message.costs().pop_back();
  EXPECT_FALSE(from_message(message));
}

TEST(Scan, IsCheckedBeforeAnybodyReadsIt) {
  sensor_msgs::msg::LaserScan scan;
  EXPECT_FALSE(check(scan)) << "empty";
  scan.angle_min(-1.0F);
  scan.angle_max(1.0F);
  scan.angle_increment(1.0F);
  scan.range_min(0.5F);
  scan.range_max(20.0F);
  scan.ranges() = {1.0F, std::numeric_limits<float>::infinity(),
                   std::numeric_limits<float>::quiet_NaN()};
  EXPECT_TRUE(check(scan));
  auto bad = scan;
  bad.ranges().pop_back();
  bad.ranges().pop_back();
  EXPECT_FALSE(check(bad)) << "truncated";
  bad = scan;
  bad.angle_increment(static_cast<float>(kNaN));
  EXPECT_FALSE(check(bad));
  bad = scan;
  bad.angle_increment(0.0F);
  EXPECT_FALSE(check(bad));
  bad = scan;
  bad.range_max(0.1F);
  EXPECT_FALSE(check(bad));
  bad = scan;
  bad.intensities() = {1.0F};
  EXPECT_FALSE(check(bad));
}

TEST(Refusals, NameTheValueThatIsNotFinite) {
  const auto error_of = [](const auto& result) { return result ? std::string() : result.error(); };
  auto pose = to_message(geometry::Pose2{});
  pose.position().z(kNaN);
  EXPECT_EQ(error_of(from_message(pose)), "pose must be finite, got z = nan");
  auto frame = to_transform(geometry::Pose3{});
  frame.rotation().y(-std::numeric_limits<double>::infinity());
  EXPECT_EQ(error_of(from_message(frame)), "pose must be finite, got quaternion.y = -inf");
  geometry_msgs::msg::Twist twist;
  twist.angular().z(kNaN);
  EXPECT_EQ(error_of(from_message(twist)), "velocity must be finite, got angular.z = nan");
  auto costs = to_message(Time{}, "odom", grid::Grid<std::uint8_t>({1, 1, 0.05, 0, 0}));
  costs.origin_y(kNaN);
  EXPECT_EQ(error_of(from_message(costs)), "grid origin must be finite, got y = nan");
  sensor_msgs::msg::LaserScan scan;
  scan.ranges() = {1.0F};
  scan.angle_max(static_cast<float>(kNaN));
  EXPECT_EQ(error_of(check(scan)), "scan angles must be finite, got angle_max = nan");
  auto covariance = to_covariance(Eigen::Matrix3d::Identity());
  covariance[11] = kNaN;
  EXPECT_EQ(error_of(from_covariance(covariance)),
            "covariance of y and yaw must be finite, got nan");
  covariance[7] = -1.0;
  covariance[11] = 0.0;
  EXPECT_EQ(error_of(from_covariance(covariance)),
            "variance of y must not be negative, got -1.000000");
}

TEST(Covariance, KeepsThePlanarPart) {
  Eigen::Matrix3d planar;
  planar << 1.0, 0.1, 0.2, 0.1, 2.0, 0.3, 0.2, 0.3, 3.0;
  const auto message = to_covariance(planar);
  EXPECT_EQ(message[0], 1.0);
  EXPECT_EQ(message[7], 2.0);
  EXPECT_EQ(message[35], 3.0);
  EXPECT_EQ(message[5], 0.2);
  const auto back = from_covariance(message);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, planar);
  auto bad = message;
  bad[0] = -1.0;
  EXPECT_FALSE(from_covariance(bad));
  bad[0] = kNaN;
  EXPECT_FALSE(from_covariance(bad));
}

}  // namespace
}  // namespace usher::wire
