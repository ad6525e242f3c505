#include "navigation/costmap/core/echo_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace usher::costmap {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kDegree = geometry::kPi / 180.0;

/// What a laser at the origin sees of a wall y = `offset`, one beam a degree from -90 to 90.
std::vector<float> wall_beside(double offset) {
  std::vector<float> ranges;
  for (int degree = -90; degree <= 90; ++degree) {
    const double s = std::sin(degree * kDegree);
    ranges.push_back(s > 0.05 ? static_cast<float>(offset / s) : kInfinity);
  }
  return ranges;
}

std::vector<float> after_check(const std::vector<float>& laser, std::vector<float> echoes,
                               const geometry::Pose2& laser_pose = {}) {
  drop_explained_echoes({laser_pose, -90 * kDegree, kDegree, laser},
                        {{}, -60 * kDegree, 30 * kDegree, {}}, 12 * kDegree, 0.3, echoes);
  return echoes;
}

TEST(EchoCheck, AWallAlongTheConeIsExplained) {
  // The cone at 30 deg hears the wall 0.7 m beside at its outer edge, 1.1 m away; on its axis that
  // is 15 cm off the wall.
  const auto echoes = after_check(wall_beside(0.7), {kInfinity, kInfinity, kInfinity, 1.1F, 0.8F});
  EXPECT_TRUE(std::isnan(echoes[3]));
  EXPECT_TRUE(std::isnan(echoes[4]));
}

TEST(EchoCheck, GlassThatTheLaserLooksThroughStays) {
  std::vector<float> laser(181, 8.0F);
  const auto echoes = after_check(laser, {kInfinity, kInfinity, 1.5F, kInfinity, kInfinity});
  EXPECT_FLOAT_EQ(echoes[2], 1.5F);
}

TEST(EchoCheck, NoEchoStaysNoEcho) {
  const auto echoes =
      after_check(wall_beside(0.7), {kInfinity, kInfinity, kInfinity, kInfinity, kInfinity});
  for (const float echo : echoes) EXPECT_EQ(echo, kInfinity);
}

TEST(EchoCheck, WithoutLaserNothingIsExplained) {
  const auto echoes = after_check({}, {1.0F, 1.0F, 1.0F, 1.0F, 1.0F});
  for (const float echo : echoes) EXPECT_FLOAT_EQ(echo, 1.0F);
}

TEST(EchoCheck, ComparesPlacesNotBearings) {
  // A post straight ahead of a laser that sits 0.3 m ahead of the sonar ring: 0.7 m for one, 1.0 m
  // for the other.
  std::vector<float> laser(181, kInfinity);
  laser[90] = 0.7F;
  EXPECT_TRUE(std::isnan(
      after_check(laser, {kInfinity, kInfinity, 1.0F, kInfinity, kInfinity}, {0.3, 0.0, 0.0})[2]));
  EXPECT_FLOAT_EQ(
      after_check(laser, {kInfinity, kInfinity, 0.6F, kInfinity, kInfinity}, {0.3, 0.0, 0.0})[2],
      0.6F);
}

}  // namespace
}  // namespace usher::costmap
