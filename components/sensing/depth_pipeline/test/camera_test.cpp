#include "sensing/depth_pipeline/core/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "foundation/geometry/pose3.hpp"

namespace usher::depth_pipeline {
namespace {

TEST(CameraPose, IsThatOfTheMountOnALeaningBody) {
  const Mount mount{.x = 0.2, .z = 0.665, .axle = 0.235};
  for (const double pitch : {-0.3, 0.0, 0.05, 0.38}) {
    for (const double angle : {-0.35, 0.0, 0.17}) {
      const geometry::Pose3 footprint_T_body{{0, 0, mount.axle},
                                             geometry::from_roll_pitch_yaw(0, pitch, 0)};
      const geometry::Pose3 body_T_camera{{mount.x, 0, mount.z},
                                          geometry::from_roll_pitch_yaw(0, -angle, 0)};
      const geometry::Pose3 expected = footprint_T_body * body_T_camera;
      const CameraPose pose = camera_pose(mount, angle, pitch);
      EXPECT_NEAR(pose.height, expected.translation.z(), 1e-12);
      EXPECT_NEAR(pose.forward, expected.translation.x(), 1e-12);
      const Eigen::Vector3d axis = expected.rotation * Eigen::Vector3d::UnitX();
      EXPECT_NEAR(pose.down, -std::asin(axis.z()), 1e-12);
    }
  }
}

TEST(CameraPose, LooksUpBehindWhenTheBodyLeansForward) {
  const CameraPose pose =
      camera_pose({.x = -0.2, .z = 0.8, .axle = 0.2, .backward = true}, 0.0, 0.1);
  EXPECT_NEAR(pose.down, -0.1, 1e-12);
  EXPECT_NEAR(pose.height, 0.2 + 0.8 * std::cos(0.1) + 0.2 * std::sin(0.1), 1e-12);
  EXPECT_NEAR(pose.forward, 0.2 * std::cos(0.1) - 0.8 * std::sin(0.1), 1e-12);
}

}  // namespace
}  // namespace usher::depth_pipeline
