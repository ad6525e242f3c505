#include "sensing/depth_pipeline/core/floor_fit.hpp"

#include <gtest/gtest.h>

#include "sensing/depth_pipeline/test/synthetic.hpp"

namespace usher::depth_pipeline {
namespace {

constexpr CameraPose kPose{.height = 0.9, .forward = 0.2, .down = 0.12};

TEST(FitFloor, FindsWhatThePredictionGotWrong) {
  SyntheticScene scene;
  scene.boxes = {{-0.5, 0.4, 0.3, 2.0, 2.4}, {0.6, 1.2, 0.8, 1.8, 2.4}};
  scene.noise = 0.0005;
  scene.dropouts = 0.03;
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    CameraPose truth = kPose;
    truth.height += random.uniform(-0.015, 0.015);
    truth.down += random.uniform(-0.012, 0.012);
    truth.roll += random.uniform(-0.01, 0.01);
    const auto image = scene.draw(truth, 10 + static_cast<std::uint64_t>(i));
    const auto fit = fit_floor(view_of(scene.camera, image), scene.camera, kPose, {});
    ASSERT_TRUE(fit.has_value()) << i;
    EXPECT_NEAR(fit->pose.height, truth.height, 0.002) << i;
    EXPECT_NEAR(fit->pose.down, truth.down, 0.0008) << i;
    EXPECT_NEAR(fit->pose.roll, truth.roll, 0.001) << i;
    EXPECT_LT(fit->residual, 0.003) << i;
  }
}

TEST(FitFloor, SaysNothingWithoutFloor) {
  SyntheticScene scene;
  scene.boxes = {{-2.5, 2.5, 2.0, 0.9, 2.0}};  // a wall before the camera
  const auto image = scene.draw(kPose);
  EXPECT_FALSE(fit_floor(view_of(scene.camera, image), scene.camera, kPose, {}).has_value());
  const std::vector<std::uint16_t> nothing(image.size(), 0);
  EXPECT_FALSE(fit_floor(view_of(scene.camera, nothing), scene.camera, kPose, {}).has_value());
}

TEST(FitFloor, RefusesMoreThanACorrection) {
  SyntheticScene scene;
  CameraPose truth = kPose;
  truth.down += 0.06;  // a ramp
  const auto image = scene.draw(truth);
  EXPECT_FALSE(fit_floor(view_of(scene.camera, image), scene.camera, kPose, {}).has_value());
}

}  // namespace
}  // namespace usher::depth_pipeline
