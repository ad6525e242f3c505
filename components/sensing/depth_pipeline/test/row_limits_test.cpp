#include "sensing/depth_pipeline/core/row_limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace usher::depth_pipeline {
namespace {

constexpr CameraPose kPose{.height = 0.9, .forward = 0.2, .down = 0.15};

/// [m] of a point at a depth [mm] in a row.
double height(const Intrinsics& camera, const CameraPose& pose, int row, double depth) {
  const double y = (row - camera.cy) / camera.fy;
  return pose.height - 1e-3 * depth * (std::sin(pose.down) + y * std::cos(pose.down));
}

TEST(FloorPrediction, LimitsAreTheDistanceDependentThreshold) {
  const Intrinsics camera;
  const FloorModel model;
  FloorPrediction floor(camera, model, 8.0);
  floor.predict(kPose);
  ASSERT_EQ(floor.strips(), 1);
  int rows = 0;
  for (int row = 0; row < camera.height; ++row) {
    const RowLimits& limits = floor.rows(0)[row];
    if (limits.obstacle >= 7999 || floor.floor_depth(row) > 8.0) continue;
    const double z = 1e-3 * limits.obstacle;
    const double slope = kPose.height / floor.floor_depth(row);
    const double threshold =
        model.floor_margin + model.angle_margin * z +
        model.noise_factor * slope * (model.noise_base + model.noise_growth * z * z);
    EXPECT_NEAR(height(camera, kPose, row, limits.obstacle), threshold, 0.0012) << row;
    ++rows;
  }
  EXPECT_GT(rows, 150);
}

TEST(FloorPrediction, AFloorLookedAtAlongItNeedsMoreHeight) {
  const Intrinsics camera;
  FloorModel model{.floor_margin = 0.004, .angle_margin = 0.0006};
  FloorPrediction calm(camera, model, 8.0);
  model.noise_grazing = 1e-4;
  FloorPrediction noisy(camera, model, 8.0);
  calm.predict(kPose);
  noisy.predict(kPose);
  int rows = 0;
  for (int row = 0; row < camera.height; ++row) {
    const double z = noisy.floor_depth(row);
    if (z > 4.0) continue;
    const double forward =
        std::cos(kPose.down) - (row - camera.cy) / camera.fy * std::sin(kPose.down);
    const double slope = kPose.height / z;
    const double upright = std::atan2(forward, slope);  // of the ray from the floor's normal
    const double ratio = upright / (1.5707963 - upright);
    const double more = 3.0 * slope * 1e-4 * std::pow(z, 1.5) * ratio * ratio;
    // To first order: the noise of a nearer point is a little smaller.
    EXPECT_NEAR(height(camera, kPose, row, noisy.rows(0)[row].obstacle) -
                    height(camera, kPose, row, calm.rows(0)[row].obstacle),
                more, 0.0012 + 0.05 * more)
        << row;
    ++rows;
  }
  EXPECT_GT(rows, 100);
}

TEST(FloorPrediction, CeilingAndLowThingsAreHeights) {
  const Intrinsics camera;
  FloorPrediction floor(camera, {}, 8.0);
  floor.predict({.height = 0.9, .forward = 0.2, .down = -0.2});
  const CameraPose& pose = floor.pose();
  EXPECT_NEAR(height(camera, pose, 0, floor.rows(0)[0].obstacle), 2.0, 0.002);
  const int bottom = camera.height - 1;
  EXPECT_NEAR(height(camera, pose, bottom, floor.rows(0)[bottom].high), 0.45, 0.002);
  EXPECT_GE(floor.rows(0)[0].high, 8000);
}

TEST(FloorPrediction, LooksForDropsOnlyNearAndBelowTheFloor) {
  const Intrinsics camera;
  const FloorModel model;
  FloorPrediction floor(camera, model, 8.0);
  floor.predict(kPose);
  for (int row = 0; row < camera.height; ++row) {
    const RowLimits& limits = floor.rows(0)[row];
    if (limits.floor == 0) continue;
    EXPECT_LE(limits.floor, 4000);
    EXPECT_LT(height(camera, kPose, row, limits.fall), -model.drop_depth) << row;
    EXPECT_GT(height(camera, kPose, row, limits.fall), -0.16) << row;
  }
  EXPECT_GT(floor.rows(0)[camera.height - 1].floor, 1000);
}

TEST(FloorPrediction, RollGivesEachStripItsOwnFloor) {
  const Intrinsics camera;
  FloorPrediction floor(camera, {}, 8.0);
  CameraPose pose = kPose;
  pose.roll = 0.05;
  floor.predict(pose);
  ASSERT_EQ(floor.strips(), FloorPrediction::kStrips);
  EXPECT_EQ(floor.first_column(0), 0);
  EXPECT_EQ(floor.first_column(8), 512);
  const int row = 400;  // the right side looks lower, so its floor is nearer
  EXPECT_LT(floor.rows(7)[row].obstacle + 50, floor.rows(0)[row].obstacle);
}

TEST(FloorModel, ThatCannotBeIsNamed) {
  FloorModel model;
  EXPECT_TRUE(check(model).ok());
  model.ceiling = std::nan("");
  EXPECT_THAT(check(model).error(), testing::HasSubstr("ceiling must be in"));
}

}  // namespace
}  // namespace usher::depth_pipeline
