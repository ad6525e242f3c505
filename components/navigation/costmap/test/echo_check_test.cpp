#include "navigation/costmap/core/echo_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
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

TEST(EchoCheck, ABeamHereAndThereThatGlassSendsBackExplainsNothing) {
  std::vector<float> laser(181, 8.0F);
  for (std::size_t beam = 80; beam < 102; beam += 3) laser[beam] = laser[beam + 1] = 1.5F;
  const auto echoes = after_check(laser, {kInfinity, kInfinity, 1.5F, kInfinity, kInfinity});
  EXPECT_FLOAT_EQ(echoes[2], 1.5F);
}

TEST(EchoCheck, GlassBeforeAPanelStays) {
  const std::vector<float> panel(181, 1.25F);
  const auto echoes = after_check(panel, {kInfinity, kInfinity, 1.0F, kInfinity, kInfinity});
  EXPECT_FLOAT_EQ(echoes[2], 1.0F);
}

TEST(EchoCheck, WhoComesNearerIsExplained) {
  const std::vector<float> who_walks(181, 1.3F);  // the echo is some time old
  EXPECT_TRUE(
      std::isnan(after_check(who_walks, {kInfinity, kInfinity, 1.5F, kInfinity, kInfinity})[2]));
}

TEST(EchoCheck, GlassBehindAChairsLegStays) {
  std::vector<float> laser(181, 8.0F);
  for (std::size_t beam = 85; beam < 90; ++beam) laser[beam] = 0.6F;
  const auto echoes = after_check(laser, {kInfinity, kInfinity, 2.0F, kInfinity, kInfinity});
  EXPECT_FLOAT_EQ(echoes[2], 2.0F);
}

/// A laser's layer around the origin that remembers posts 5 cm wide.
struct Remembers {
  Remembers(std::initializer_list<geometry::Point2> posts) {
    std::vector<geometry::Point2> points(posts);
    EXPECT_TRUE(layer.replace(points, 1.0, raster));
  }
  Raster raster{.resolution = 0.05,
                .cells_per_meter = 20.0,
                .first_x = -60,
                .first_y = -60,
                .width = 120,
                .height = 120};
  ObstacleLayer layer{{.name = "laser"}, raster};

  float after(float echo, const geometry::Pose2& sonar = {}) const {
    std::vector<float> echoes{echo};
    const auto rays = cone_directions(0.0, 0.5, 1, 0.28, 13);
    drop_remembered_echoes(layer, raster, sonar, rays, 0.15, echoes);
    return echoes[0];
  }
};

TEST(EchoCheck, AWallThatTheLaserRemembersIsExplained) {
  const Remembers wall({{0.42, -0.1}, {0.42, -0.05}, {0.42, 0.0}, {0.42, 0.05}});
  EXPECT_TRUE(std::isnan(wall.after(0.5F)));
  EXPECT_FLOAT_EQ(wall.after(0.8F), 0.8F) << "too far from it";
  EXPECT_FLOAT_EQ(wall.after(0.5F, {0.0, 0.0, geometry::kPi}), 0.5F) << "looks the other way";
  EXPECT_EQ(wall.after(kInfinity), kInfinity);
}

TEST(EchoCheck, ACellThatGlassLeftInTheLaserLayerExplainsNothing) {
  const Remembers stray({{1.5, 0.0}});
  EXPECT_FLOAT_EQ(stray.after(1.5F), 1.5F);
}

TEST(EchoCheck, OutsideOfTheWindowNothingIsRemembered) {
  const Remembers wall({{0.4, 0.0}});
  EXPECT_FLOAT_EQ(wall.after(0.5F, {100.0, 0.0, 0.0}), 0.5F);
  EXPECT_FLOAT_EQ(wall.after(0.5F, {1e300, 0.0, 0.0}), 0.5F);
}

TEST(Cones, FanOutAroundTheAxis) {
  const auto rays = cone_directions(-0.5, 0.5, 3, 0.2, 5);
  ASSERT_EQ(rays.size(), 15U);
  EXPECT_NEAR(std::atan2(rays[0].y(), rays[0].x()), -0.6, 1e-12);
  EXPECT_NEAR(std::atan2(rays[7].y(), rays[7].x()), 0.0, 1e-12);
  EXPECT_NEAR(std::atan2(rays[14].y(), rays[14].x()), 0.6, 1e-12);
}

TEST(Cones, AnEchoIsOnAllOfItsArcButANearOneOnTheAxis) {
  std::vector<float> ranges;
  const auto rays = cone_directions(-0.75, 0.5, 4, 0.28, 3);
  spread_echoes(std::vector<float>{1.7F, 0.4F, kInfinity, NAN}, rays, {}, {}, ranges);
  ASSERT_EQ(ranges.size(), 12U);
  for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(ranges[static_cast<std::size_t>(i)], 1.7F);
  EXPECT_TRUE(std::isnan(ranges[3]) && std::isnan(ranges[5]));
  EXPECT_FLOAT_EQ(ranges[4], 0.4F);
  for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(ranges[i], kInfinity);
  for (std::size_t i = 9; i < 12; ++i) EXPECT_TRUE(std::isnan(ranges[i]));
}

TEST(Cones, AFarEchoIsOnNoMoreThanHalfAMeter) {
  std::vector<float> ranges;
  const auto rays = cone_directions(-0.14, 0.28, 1, 0.28, 13);
  spread_echoes(std::vector<float>{2.5F}, rays, {}, {}, ranges);
  const auto marked =
      std::count_if(ranges.begin(), ranges.end(), [](float r) { return r == 2.5F; });
  EXPECT_EQ(marked, 9) << "of rays 0.058 m apart";
  EXPECT_TRUE(std::isnan(ranges.front()) && std::isnan(ranges.back()));
  EXPECT_EQ(ranges[6], 2.5F);
  spread_echoes(std::vector<float>{kInfinity}, rays, {}, {}, ranges);
  EXPECT_EQ(ranges.front(), kInfinity);
}

TEST(Cones, TellNothingAtTheirEdges) {
  const auto rays = cone_directions(-0.25, 0.5, 2, 0.28, 5);
  std::vector<float> ranges(10, 1.0F);
  std::fill_n(ranges.begin() + 5, 5, kInfinity);
  keep_middle(rays, 2, 0.16, ranges);
  for (const std::size_t edge : {0U, 4U, 5U, 9U}) EXPECT_TRUE(std::isnan(ranges[edge])) << edge;
  for (const std::size_t middle : {1U, 2U, 3U}) EXPECT_EQ(ranges[middle], 1.0F);
  for (const std::size_t middle : {6U, 7U, 8U}) EXPECT_EQ(ranges[middle], kInfinity);
  std::vector<float> axis{1.0F, 1.0F, 1.0F};
  keep_middle(cone_directions(1.0, 0.0, 1, 0.28, 3), 1, 0.0, axis);
  EXPECT_TRUE(std::isnan(axis[0]) && axis[1] == 1.0F && std::isnan(axis[2]));
  std::vector<float> none{-1.0F, 0.0F, -kInfinity};
  keep_middle(cone_directions(0.0, 0.5, 3, 0.28, 1), 3, 0.16, none);
  for (const float range : none) EXPECT_TRUE(std::isnan(range));
  keep_middle({}, 0, 0.16, {});
}

TEST(Cones, TheEchoOfAPersonIsOnTheAxisAlone) {
  std::vector<float> ranges;
  const auto rays = cone_directions(-0.25, 0.5, 2, 0.28, 3);
  const std::vector<geometry::Point2> people{{5.0 + 1.8, 1.0 - 0.3}};
  spread_echoes(std::vector<float>{1.7F, 1.7F}, rays, {5.0, 1.0, 0.0}, people, ranges);
  EXPECT_TRUE(std::isnan(ranges[0]) && std::isnan(ranges[2]));
  EXPECT_FLOAT_EQ(ranges[1], 1.7F);
  EXPECT_FLOAT_EQ(ranges[3], 1.7F) << "nobody stands before the other one";
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
  laser[89] = laser[90] = laser[91] = 0.7F;
  EXPECT_TRUE(std::isnan(
      after_check(laser, {kInfinity, kInfinity, 1.0F, kInfinity, kInfinity}, {0.3, 0.0, 0.0})[2]));
  EXPECT_FLOAT_EQ(
      after_check(laser, {kInfinity, kInfinity, 0.6F, kInfinity, kInfinity}, {0.3, 0.0, 0.0})[2],
      0.6F);
}

}  // namespace
}  // namespace usher::costmap
