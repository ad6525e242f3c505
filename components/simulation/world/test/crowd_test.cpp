// People in a corridor with a robot that stands in it.
#include "simulation/world/core/crowd.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "simulation/world/core/base.hpp"

namespace usher::world {
namespace {

constexpr double kHalfWidth = 0.7;  // [m] of the corridor along x

Scene corridor() {
  return {{wall("south", {-20, -kHalfWidth - 0.1}, {20, -kHalfWidth - 0.1}, 0.2, 2.7),
           wall("north", {-20, kHalfWidth + 0.1}, {20, kHalfWidth + 0.1}, 0.2, 2.7)},
          2.7};
}

struct Robot {
  Pose2 pose;
  std::vector<Point2> footprint;

  explicit Robot(const Pose2& at) : pose(at) {
    for (const Point2& corner :
         {Point2(-0.305, -0.33), Point2(0.305, -0.33), Point2(0.305, 0.33), Point2(-0.305, 0.33)})
      footprint.push_back(at * corner);
  }
};

/// How far west and east somebody gets who walks between the two ends within `seconds`.
std::pair<double, double> walked(const Robot& robot, const std::vector<Point2>& loop,
                                 double seconds) {
  const PersonPlan plan{.name = "ada", .start = {}, .speed = 1.2, .loop = loop};
  Crowd crowd({}, std::span(&plan, 1), robot.pose.position(), 1);
  const Scene scene = corridor();
  double west = 99.0, east = -99.0;
  for (int i = 0; i < static_cast<int>(seconds / kStep); ++i) {
    crowd.step(scene, {robot.pose, robot.footprint});
    west = std::min(west, crowd.people()[0].position.x());
    east = std::max(east, crowd.people()[0].position.x());
    EXPECT_LT(std::abs(crowd.people()[0].position.y()), kHalfWidth);
  }
  return {west, east};
}

TEST(Crowd, SqueezesPastARobotThatStandsAtTheWall) {
  const auto [west, east] = walked(Robot({0.0, 0.33, 0.0}), {{-5, 0}, {5, 0}}, 40.0);
  EXPECT_LT(west, -3.0);
  EXPECT_GT(east, 3.0);
}

TEST(Crowd, WearsClothesOfTheSeedAndTheName) {
  const std::vector<PersonPlan> plans{{.name = "ada"}, {.name = "boole"}};
  const Crowd crowd({}, plans, {5.0, 5.0}, 1), same({}, plans, {9.0, 9.0}, 1),
      other({}, plans, {5.0, 5.0}, 2);
  EXPECT_EQ(crowd.people()[0].clothes.upper, same.people()[0].clothes.upper);
  EXPECT_EQ(crowd.people()[1].clothes.legs, same.people()[1].clothes.legs);
  EXPECT_NE(crowd.people()[0].clothes.upper, crowd.people()[1].clothes.upper);
  EXPECT_NE(crowd.people()[0].clothes.upper, other.people()[0].clothes.upper);
}

TEST(Crowd, WalksAwayFromARobotThatBarsBothWaysAlongTheLoop) {
  // Pushed off her loop, she stands east of a robot that leaves her 0.37 m at its sides.
  const PersonPlan plan{.name = "ada", .start = {}, .speed = 1.2, .loop = {{-8, 0}, {-4, 0}}};
  Crowd crowd({}, std::span(&plan, 1), {-12, 0}, 1);
  const Scene scene = corridor();
  const int steps = static_cast<int>(60.0 / kStep);
  for (int i = 0; i < steps; ++i) {
    const Robot robot({-12.0 + 0.2 * kStep * i, 0.0, 0.0});
    crowd.step(scene, {robot.pose, robot.footprint});
  }
  const Robot robot({0.0, 0.0, 0.0});
  double farthest = 0.0;
  for (int i = 0; i < static_cast<int>(20.0 / kStep); ++i) {
    crowd.step(scene, {robot.pose, robot.footprint});
    farthest = std::max(farthest, crowd.people()[0].position.x());
  }
  EXPECT_GT(farthest, 4.0);
}

TEST(Crowd, WhoFollowsMakesRoomForARobotThatBacksOff) {
  const PersonPlan plan{.name = "ada", .start = {-1.1, 0.0}, .speed = 1.2, .loop = {}};
  Crowd crowd({}, std::span(&plan, 1), {0, 0}, 1);
  const Scene scene = corridor();
  ASSERT_TRUE(crowd.send("ada", {0, 0}, 1.2, true).ok());
  double nearest = 99.0;
  for (int i = 0; i < static_cast<int>(6.7 / kStep); ++i) {
    const double x = -0.15 * kStep * i;
    const Robot robot({x, 0.0, 0.0});
    crowd.step(scene, {robot.pose, robot.footprint});
    nearest = std::min(nearest, (crowd.people()[0].position - Point2(x, 0.0)).norm());
  }
  EXPECT_GT(nearest, 0.67) << "0.1 m of room between them";
  EXPECT_LT(crowd.people()[0].position.x(), -1.6);
}

TEST(Crowd, WhoSitsStaysOnTheSeatThoughARobotDrivesIntoHim) {
  const PersonPlan plan{
      .name = "ada", .start = {1.0, 0.0}, .posture = rendering::Posture::kSitting};
  Crowd crowd({}, std::span(&plan, 1), {0, 0}, 1);
  const Scene scene = corridor();
  for (int i = 0; i < static_cast<int>(5.0 / kStep); ++i) {
    const Robot robot({std::min(0.5, 0.2 * kStep * i), 0.0, 0.0});
    crowd.step(scene, {robot.pose, robot.footprint});
  }
  EXPECT_EQ(crowd.people()[0].position.x(), 1.0);
  EXPECT_EQ(crowd.people()[0].position.y(), 0.0);
  EXPECT_EQ(crowd.people()[0].posture, rendering::Posture::kSitting);
}

}  // namespace
}  // namespace usher::world
