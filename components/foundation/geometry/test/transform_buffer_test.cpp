#include "foundation/geometry/transform_buffer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace usher::geometry {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

Pose3 along_x(double x, double yaw = 0.0) { return to_space({x, 0.0, yaw}); }

TransformBuffer robot() {
  TransformBuffer buffer;
  EXPECT_TRUE(buffer.add("map", "odom", seconds(1), along_x(10.0)));
  EXPECT_TRUE(buffer.add("map", "odom", seconds(2), along_x(10.0)));
  EXPECT_TRUE(buffer.add("odom", "base", seconds(1), along_x(0.0)));
  EXPECT_TRUE(buffer.add("odom", "base", seconds(2), along_x(1.0, 0.2)));
  EXPECT_TRUE(buffer.add_static("base", "laser", along_x(0.5)));
  return buffer;
}

TEST(TransformBuffer, InterpolatesBetweenSamplesAndThroughStaticFrames) {
  const auto pose = robot().lookup("map", "laser", milliseconds(1500));
  ASSERT_TRUE(pose) << pose.error();
  const Pose2 planar = to_plane(*pose);
  EXPECT_NEAR(planar.x, 10.5 + 0.5 * std::cos(0.1), 1e-12);
  EXPECT_NEAR(planar.y, 0.5 * std::sin(0.1), 1e-12);
  EXPECT_NEAR(planar.yaw, 0.1, 1e-12);
}

TEST(TransformBuffer, LookupUpIsTheInverseOfLookupDown) {
  const auto buffer = robot();
  const auto down = buffer.lookup("map", "laser", milliseconds(1700));
  const auto up = buffer.lookup("laser", "map", milliseconds(1700));
  ASSERT_TRUE(down && up);
  EXPECT_TRUE((*down * *up).translation.isZero(1e-12));
}

TEST(TransformBuffer, JoinsSiblingsBelowACommonFrame) {
  auto buffer = robot();
  ASSERT_TRUE(buffer.add_static("base", "whisker", along_x(-0.5)));
  const auto pose = buffer.lookup("whisker", "laser", seconds(2));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 1.0, 1e-12);
}

TEST(TransformBuffer, ExtrapolatesByTheRateAndNoFurtherThanItsReach) {
  const auto buffer = robot();
  const auto pose = buffer.lookup("odom", "base", milliseconds(2020));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 1.02, 1e-9);
  const auto late = buffer.lookup("odom", "base", milliseconds(2021));
  ASSERT_FALSE(late);
  EXPECT_NE(late.error().find("base"), std::string::npos);
  EXPECT_FALSE(buffer.lookup("odom", "base", milliseconds(999)));
}

TEST(TransformBuffer, HoldsTheNewestOfSamplesTooNearForARate) {
  auto buffer = robot();
  ASSERT_TRUE(buffer.add("odom", "base", seconds(2) + std::chrono::nanoseconds(1), along_x(1.001)));
  const auto pose = buffer.lookup("odom", "base", milliseconds(2020));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 1.001, 1e-9);
}

TEST(TransformBuffer, ForgetsWhatIsOlderThanItsMemory) {
  auto buffer = robot();
  ASSERT_TRUE(buffer.add("odom", "base", seconds(12), along_x(2.0)));
  EXPECT_FALSE(buffer.lookup("odom", "base", milliseconds(1500)));
  EXPECT_TRUE(buffer.lookup("odom", "base", seconds(7)));
}

TEST(TransformBuffer, RefusesWhatWouldCorruptTheTree) {
  auto buffer = robot();
  EXPECT_FALSE(buffer.add("map", "base", seconds(3), along_x(0.0))) << "second parent";
  EXPECT_FALSE(buffer.add("odom", "base", seconds(1), along_x(0.0))) << "older than the newest";
  EXPECT_FALSE(buffer.add("odom", "odom", seconds(3), along_x(0.0))) << "own parent";
  EXPECT_FALSE(
      buffer.add("odom", "base", seconds(3), along_x(std::numeric_limits<double>::quiet_NaN())));
  Pose3 stretched;
  stretched.rotation = Eigen::Quaterniond(2.0, 0.0, 0.0, 0.0);
  EXPECT_FALSE(buffer.add("odom", "base", seconds(3), stretched));
  EXPECT_TRUE(buffer.lookup("map", "laser", seconds(2)));
}

TEST(TransformBuffer, SurvivesALoopOfParents) {
  TransformBuffer buffer;
  ASSERT_TRUE(buffer.add_static("a", "b", along_x(1.0)));
  ASSERT_TRUE(buffer.add_static("b", "a", along_x(1.0)));
  EXPECT_FALSE(buffer.lookup("c", "a", seconds(0)));
  EXPECT_FALSE(buffer.newest("c", "a"));
}

TEST(TransformBuffer, AFrameThatNeverMovesKeepsItsPlace) {
  auto buffer = robot();
  EXPECT_TRUE(buffer.add_static("base", "laser", along_x(0.5)));
  EXPECT_THAT(buffer.add_static("base", "laser", along_x(0.6)).error(), HasSubstr("another place"));
  EXPECT_THAT(buffer.add("base", "laser", seconds(3), along_x(0.6)).error(),
              HasSubstr("never moves"));
  EXPECT_THAT(buffer.add_static("odom", "base", along_x(9.0)).error(), HasSubstr("moves"));
  EXPECT_EQ(buffer.lookup("base", "laser", seconds(60))->translation.x(), 0.5);
  EXPECT_NEAR(buffer.lookup("odom", "base", seconds(2))->translation.x(), 1.0, 1e-12);
}

TEST(TransformBuffer, NewestIsTheOldestOfTheNewestOnTheWay) {
  auto buffer = robot();
  ASSERT_TRUE(buffer.add("odom", "base", milliseconds(2010), along_x(1.0)));
  EXPECT_EQ(*buffer.newest("map", "laser"), seconds(2));
  EXPECT_EQ(*buffer.newest("odom", "laser"), milliseconds(2010));
  EXPECT_EQ(*buffer.newest("base", "laser"), seconds(0));
  EXPECT_FALSE(buffer.newest("map", "nothing"));
}

TEST(Pose3, PositivePitchLeansForward) {
  const Eigen::Vector3d top = from_roll_pitch_yaw(0.0, 0.1, 0.0) * Eigen::Vector3d::UnitZ();
  EXPECT_GT(top.x(), 0.0);
}

TEST(Pose2, IntegratesAnExactArc) {
  const Pose2 quarter = integrate({0, 0, 0}, {kPi / 2, kPi / 2}, 1.0);
  EXPECT_NEAR(quarter.x, 1.0, 1e-12);
  EXPECT_NEAR(quarter.y, 1.0, 1e-12);
  EXPECT_NEAR(quarter.yaw, kPi / 2, 1e-12);
  const Pose2 straight = integrate({0, 0, 0}, {1.0, 1e-9}, 1.0);
  EXPECT_NEAR(straight.x, 1.0, 1e-9);
}

TEST(Pose2, ComposesWithItsInverseToNothing) {
  const Pose2 a{1.0, -2.0, 2.5};
  const Pose2 nothing = a * inverse(a);
  EXPECT_NEAR(nothing.x, 0.0, 1e-12);
  EXPECT_NEAR(nothing.y, 0.0, 1e-12);
  EXPECT_NEAR(nothing.yaw, 0.0, 1e-12);
}

}  // namespace
}  // namespace usher::geometry
