#include "sensing/depth_pipeline/core/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sensing/depth_pipeline/test/synthetic.hpp"

namespace usher::depth_pipeline {
namespace {

using geometry::radians;
using testing::HasSubstr;

TEST(FloorLine, IsFoundAmongBoxesAndNoise) {
  SyntheticScene scene;
  scene.boxes = {{-0.3, 0.3, 0.5, 3.0, 3.4}};
  scene.noise = 0.0005;
  scene.dropouts = 0.03;
  for (const double down : {radians(-4.0), 0.0, radians(5.0), radians(20.0)}) {
    const CameraPose pose{.height = 0.9, .forward = 0.2, .down = down};
    const auto image = scene.draw(pose);
    const auto floor = find_floor_line(view_of(scene.camera, image), scene.camera);
    ASSERT_TRUE(floor.ok()) << floor.error();
    EXPECT_NEAR(floor->down, down, radians(0.1));
    EXPECT_NEAR(floor->height, 0.9, 0.003);
    EXPECT_LT(floor->residual, 0.004);
  }
}

TEST(FloorLine, IsRefusedWhereThereIsNone) {
  SyntheticScene scene;
  scene.boxes = {{-2.5, 2.5, 2.0, 1.0, 2.0}};
  const CameraPose pose{.height = 0.9, .forward = 0.2, .down = 0.1};
  const auto wall = scene.draw(pose);
  EXPECT_FALSE(find_floor_line(view_of(scene.camera, wall), scene.camera).ok());
  const std::vector<std::uint16_t> nothing(wall.size(), 0);
  EXPECT_THAT(find_floor_line(view_of(scene.camera, nothing), scene.camera).error(),
              HasSubstr("only 0 pixels"));
  EXPECT_FALSE(find_floor_line({640, 480, wall}, scene.camera).ok());
}

TEST(FloorLine, IsNotUnevenForAWallBehindItOrATableLegOnIt) {
  SyntheticScene scene;
  scene.end = 3.0;
  scene.boxes = {{-0.02, 0.02, 0.7, 2.0, 2.04}};
  scene.noise = 0.0005;
  for (const double down : {0.0, 0.2, 0.35}) {
    const auto image = scene.draw({.height = 0.9, .forward = 0.2, .down = down});
    const auto floor = find_floor_line(view_of(scene.camera, image), scene.camera);
    ASSERT_TRUE(floor.ok()) << floor.error();
    EXPECT_LT(floor->residual, 0.004);
  }
}

/// An image of a floor that is `height(ahead)` high, with noise.
template <class Height>
std::vector<std::uint16_t> draw_floor(const Intrinsics& camera, const CameraPose& pose,
                                      Height&& height) {
  std::vector<std::uint16_t> image;
  Random random(42);
  for (int row = 0; row < camera.height; ++row) {
    const double y = (row - camera.cy) / camera.fy;
    const double forward = std::cos(pose.down) - y * std::sin(pose.down);
    const double fall = std::sin(pose.down) + y * std::cos(pose.down);
    double depth = 0.5;
    while (depth < 8.0 && pose.height - fall * depth > height(forward * depth)) depth += 1e-3;
    for (int column = 0; column < camera.width; ++column) {
      const double noisy = depth + 0.0005 * depth * depth * random.gaussian();
      image.push_back(depth < 8.0 ? static_cast<std::uint16_t>(std::lround(noisy * 1e3))
                                  : std::uint16_t{0});
    }
  }
  return image;
}

TEST(FloorLine, OfAnUnevenFloorIsRefusedThoughMostOfItLiesOnALine) {
  const Intrinsics camera;
  const auto complaint = [&](auto&& height) {
    const auto image = draw_floor(camera, {.height = 0.9, .forward = 0.2, .down = 0.35}, height);
    const auto floor = find_floor_line(view_of(camera, image), camera);
    return floor ? std::string() : floor.error();
  };
  const auto uneven = HasSubstr("the floor is uneven by");
  EXPECT_EQ(complaint([](double) { return 0.0; }), "");
  EXPECT_EQ(complaint([](double x) { return x > 2.0 && x < 2.1 ? 0.01 : 0.0; }), "") << "a bar";
  EXPECT_THAT(complaint([](double x) { return std::max(0.0, 0.06 * (x - 1.5)); }), uneven);
  EXPECT_THAT(complaint([](double x) { return 0.02 * std::sin(2.0 * geometry::kPi * x); }), uneven);
  EXPECT_THAT(complaint([](double x) { return x > 2.2 ? 0.06 : 0.0; }), uneven);
  EXPECT_THAT(complaint([](double x) { return x > 2.2 ? -0.06 : 0.0; }), uneven);
}

std::vector<TiltSample> sweep(double gain, double offset, double z, double slope) {
  std::vector<TiltSample> samples;
  for (int i = -5; i <= 5; ++i) {
    TiltSample s;
    s.servo = radians(4.0 * i);
    s.angle = (s.servo - offset) / gain;
    s.mount_z = z + slope * s.angle;
    samples.push_back(s);
  }
  return samples;
}

TEST(Calibration, FindsTheLinesAndLeavesOutliersAside) {
  auto samples = sweep(0.93, radians(2.5), 0.671, 0.04);
  samples[2].angle += radians(3.0);
  samples[7].mount_z -= 0.05;
  const auto found = fit_calibration(samples);
  ASSERT_TRUE(found.ok()) << found.error();
  EXPECT_NEAR(found->servo.gain, 0.93, 1e-6);
  EXPECT_NEAR(found->servo.offset, radians(2.5), 1e-6);
  EXPECT_NEAR(found->mount_z, 0.671, 1e-6);
  EXPECT_NEAR(found->mount_z_slope, 0.04, 1e-5);
  EXPECT_FALSE(found->used[2]);
  EXPECT_FALSE(found->used[7]);
  EXPECT_TRUE(found->used[0]);
}

TEST(Calibration, RefusesBadDataWithTheReason) {
  auto samples = sweep(1.0, 0.0, 0.67, 0.0);
  EXPECT_THAT(fit_calibration({samples.begin(), samples.begin() + 4}).error(),
              HasSubstr("4 tilt positions"));
  for (TiltSample& s : samples) s.servo *= 0.1;
  EXPECT_THAT(fit_calibration(samples).error(), HasSubstr("10 deg"));
  samples = sweep(1.0, 0.0, 0.67, 0.0);
  Random random(4);
  for (TiltSample& s : samples) s.angle += random.uniform(-0.1, 0.1);
  EXPECT_THAT(fit_calibration(samples).error(), HasSubstr("lie on one line"));
  EXPECT_THAT(fit_calibration(sweep(3.0, 0.0, 0.67, 0.0)).error(), HasSubstr("gain"));
  EXPECT_THAT(fit_calibration(sweep(1.0, 0.0, 9.0, 0.0)).error(), HasSubstr("above the axle"));
}

TEST(TiltSweep, SaysWhyAPositionGaveNothing) {
  SyntheticScene scene;
  TiltSweep::Config config;
  config.positions = 5;
  config.patience = 20;
  TiltSweep sweep(scene.camera, config);
  const auto image = scene.draw({.height = 0.9, .forward = 0.2, .down = 0.1});
  for (int i = 0; i < 5 * 20; ++i) sweep.take(view_of(scene.camera, image), 0.7, 0.0);
  EXPECT_TRUE(sweep.done());
  EXPECT_TRUE(sweep.samples().empty());
  EXPECT_THAT(sweep.complaint(), HasSubstr("the servo does not reach"));
}

}  // namespace
}  // namespace usher::depth_pipeline
