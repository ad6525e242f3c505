#include "simulation/world/core/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace usher::world {
namespace {

using geometry::Pose3;
using geometry::radians;

Pose3 marvin(double pitch = 0.0) {
  return {{0.0, 0.0, 0.235}, geometry::from_roll_pitch_yaw(0.0, pitch, 0.0)};
}

Scene wall_ahead(double x) { return {{wall("wall", {x + 0.1, -9}, {x + 0.1, 9}, 0.2, 2.7)}, 2.7}; }

TEST(Laser, MeasuresWithinItsDataSheet) {
  const Scene scene = wall_ahead(5.0);
  double lowest_bias = 1.0;
  double highest_bias = -1.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Laser laser(LaserConfig{.mixed_share = 0.0}, seed);
    std::vector<float> ranges;
    double sum = 0.0;
    double squares = 0.0;
    constexpr int kTurns = 400;
    for (int i = 0; i < kTurns; ++i) {
      laser.scan(scene, {}, marvin(), ranges);
      const double error = static_cast<double>(ranges[270]) - (5.0 - 0.28);
      sum += error;
      squares += error * error;
    }
    const double bias = sum / kTurns;
    EXPECT_LE(std::abs(bias), 0.032);
    EXPECT_NEAR(std::sqrt(squares / kTurns - bias * bias), 0.012, 0.002);
    lowest_bias = std::min(lowest_bias, bias);
    highest_bias = std::max(highest_bias, bias);
  }
  EXPECT_GT(highest_bias - lowest_bias, 0.02) << "every device has its own error";
}

TEST(Laser, Has541BeamsOver270Degrees) {
  Laser laser(LaserConfig{}, 1);
  std::vector<float> ranges;
  laser.scan(wall_ahead(5.0), {}, marvin(), ranges);
  ASSERT_EQ(ranges.size(), 541U);
  EXPECT_NEAR(laser.config().angle_min, radians(-135), 1e-9);
  EXPECT_NEAR(laser.config().angle_min + 540 * laser.config().increment, radians(135), 1e-9);
}

TEST(Laser, HitsItsOwnBodyBeyond2Radians) {
  Laser laser(LaserConfig{}, 1);
  std::vector<float> ranges;
  laser.scan(Scene({}, 2.7), {}, marvin(), ranges);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle =
        laser.config().angle_min + static_cast<double>(i) * laser.config().increment;
    if (std::abs(angle) > 2.0) {
      EXPECT_GT(ranges[i], 0.15F);
      EXPECT_LT(ranges[i], 0.36F);
    } else {
      EXPECT_TRUE(std::isinf(ranges[i])) << "nothing there";
    }
  }
}

TEST(Laser, SeesTheFloorWhenItLeans) {
  Laser laser(LaserConfig{.statistical_error = 0.0, .systematic_error = 0.0}, 1);
  std::vector<float> ranges;
  for (const double pitch : {8.0, 12.0, 22.0}) {
    laser.scan(Scene({}, 2.7), {}, marvin(radians(pitch)), ranges);
    const double height =
        0.235 + 0.065 * std::cos(radians(pitch)) - 0.28 * std::sin(radians(pitch));
    EXPECT_NEAR(ranges[270], height / std::sin(radians(pitch)), 2e-3) << pitch;
  }
}

TEST(Laser, MissesGlassExceptRarely) {
  Thing pane = wall("pane", {3.0, -9}, {3.0, 9}, 0.02, 2.7);
  pane.material = Material::kGlass;
  const Scene scene({pane}, 2.7);
  Laser laser(LaserConfig{}, 1);
  std::vector<float> ranges;
  int seen = 0;
  int oblique = 0;
  for (int i = 0; i < 500; ++i) {
    laser.scan(scene, {}, marvin(), ranges);
    seen += std::isfinite(ranges[270]) ? 1 : 0;
    oblique += std::isfinite(ranges[270 + 90]) ? 1 : 0;
  }
  EXPECT_NEAR(seen / 500.0, 0.1, 0.05);
  EXPECT_EQ(oblique, 0);
}

TEST(Laser, SeesPeople) {
  Laser laser(LaserConfig{}, 1);
  std::vector<float> ranges;
  const Mover person{.center = {2.0, 0.0}};
  laser.scan(Scene({}, 2.7), std::span(&person, 1), marvin(), ranges);
  EXPECT_NEAR(ranges[270], 2.0 - 0.28 - 0.25, 0.08);
}

TEST(Laser, RepeatsEveryBit) {
  const Scene scene = wall_ahead(5.0);
  Laser a(LaserConfig{}, 5);
  Laser b(LaserConfig{}, 5);
  std::vector<float> first;
  std::vector<float> second;
  for (int i = 0; i < 5; ++i)
    a.scan(scene, {}, marvin(), first), b.scan(scene, {}, marvin(), second);
  EXPECT_EQ(first, second);
}

TEST(Sonar, SeesGlassInStepsOfAnInch) {
  Thing pane = wall("pane", {2.0, -9}, {2.0, 9}, 0.02, 2.7);
  pane.material = Material::kGlass;
  Sonar sonar(SonarConfig{}, 1);
  std::vector<float> ranges;
  sonar.measure(Scene({pane}, 2.7), {}, marvin(), ranges);
  ASSERT_EQ(ranges.size(), 5U);
  EXPECT_NEAR(ranges[2], 1.99 - 0.30, 0.04);
  const double inches = static_cast<double>(ranges[2]) / 0.0254;
  EXPECT_NEAR(inches, std::round(inches), 1e-3);
}

TEST(Sonar, CountsFromTheRightAndIsDeafBeyond6Metres) {
  const Thing bin = disc("bin", Point2(1.5 * std::cos(radians(-60)), 1.5 * std::sin(radians(-60))),
                         0.2, 0.0, 1.0);
  Sonar sonar(SonarConfig{}, 1);
  std::vector<float> ranges;
  sonar.measure(Scene({bin, wall("far", {8, -9}, {8, 9}, 0.2, 2.7)}, 2.7), {}, marvin(), ranges);
  EXPECT_NEAR(ranges[0], 1.0, 0.06);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_TRUE(std::isinf(ranges[i])) << i;
}

TEST(Sonar, LosesTheEchoOfAGrazingSurface) {
  const Scene scene({wall("side", {-9, 1.0}, {9, 1.0}, 0.1, 2.7)}, 2.7);
  Sonar sonar(SonarConfig{}, 1);
  std::vector<float> ranges;
  sonar.measure(scene, {}, marvin(), ranges);
  EXPECT_TRUE(std::isinf(ranges[2]));
  EXPECT_TRUE(std::isinf(ranges[3])) << "60 degrees from the normal";
  EXPECT_NEAR(ranges[4], (0.95 - 0.3 * std::sin(radians(60))) / std::sin(radians(68)), 0.06);
}

TEST(Whiskers, BendWhereSomethingCrossesThem) {
  Whiskers whiskers(WhiskerConfig{});
  const auto at = [&](const Thing& thing) {
    return whiskers.touch(Scene({thing}, 2.7), {}, {0.0, 0.0, 0.0});
  };
  EXPECT_TRUE(at(disc("post", {0.6, 0.38}, 0.05, 0.0, 1.0)).front_left);
  EXPECT_FALSE(at(disc("post", {0.6, 0.38}, 0.05, 0.0, 1.0)).front_right);
  EXPECT_TRUE(at(disc("post", {0.6, -0.38}, 0.05, 0.0, 1.0)).front_right);
  EXPECT_TRUE(at(disc("post", {-0.6, 0.38}, 0.05, 0.0, 1.0)).back_left);
  EXPECT_TRUE(at(disc("post", {-0.6, -0.38}, 0.05, 0.0, 1.0)).back_right);
  EXPECT_FALSE(at(disc("low", {0.6, 0.38}, 0.05, 0.0, 0.1)).front_left) << "passes under";
  EXPECT_FALSE(at(box("door frame", {0.6, 0.47, 0.0}, 0.1, 0.1, 0.0, 2.0)).front_left)
      << "brushing along, 7 cm beside the robot";
  const WhiskerContacts none = at(disc("post", {1.0, 0.0}, 0.05, 0.0, 1.0));
  EXPECT_FALSE(none.front_left || none.front_right || none.back_left || none.back_right);
}

TEST(Whiskers, StayBentByAWallThatTheOutlineAlmostTouches) {
  Whiskers whiskers(WhiskerConfig{});
  const WhiskerContacts beside =
      whiskers.touch(Scene({box("wall", {0.0, 0.44, 0.0}, 4.0, 0.2, 0.0, 2.0)}, 2.7), {}, {});
  EXPECT_TRUE(beside.front_left && beside.back_left);
  EXPECT_FALSE(beside.front_right || beside.back_right);
}

TEST(Whiskers, BendAtPeople) {
  Whiskers whiskers(WhiskerConfig{});
  const Mover person{.center = {0.8, -0.5}};
  EXPECT_TRUE(whiskers.touch(Scene({}, 2.7), std::span(&person, 1), {}).front_right);
}

}  // namespace
}  // namespace usher::world
