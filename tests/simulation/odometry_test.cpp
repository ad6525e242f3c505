// What the driver makes of the simulated base's wheels is the way that the base went.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "foundation/geometry/angle.hpp"
#include "operations/command_line/installation.hpp"
#include "operations/experiments/commanded_robot.hpp"
#include "operations/experiments/lockstep_run.hpp"
#include "wire/conversions.hpp"

namespace usher::operations {
namespace {

/// The course leads left, then right: by 57 and by 80 deg.
TEST(Odometry, TurnsAsFarAsTheRobot) {
  const std::string share = std::string(USHER_BINARY_DIR) + "/share/usher";
  const Installation installation{
      .programs = {}, .contracts = share + "/contracts", .share = share};
  const auto deployment = load_deployment(share + "/deploy/obstacle-course.yaml", installation, {});
  ASSERT_TRUE(deployment.ok()) << deployment.error();
  double truth = 0.0, turned = 0.0, worst = 0.0, before = 0.0;
  std::optional<double> offset;
  const auto robot = lockstep_robot(*deployment, 1, [&](LockstepRun& run) {
    run.world().observe(topics::kSimGroundTruth, [&](const auto& message, const auto&) {
      const auto pose = wire::to_planar(message.pose());
      if (pose) truth = pose->yaw;
    });
    run.world().observe(topics::kOdom, [&](const auto& message, const auto&) {
      const auto pose = wire::to_planar(message.pose().pose());
      if (!pose) return;
      if (!offset) offset = pose->yaw - truth, before = truth;
      turned += std::abs(geometry::normalized(truth - before));
      before = truth;
      worst = std::max(worst, std::abs(geometry::normalized(pose->yaw - truth - *offset)));
    });
  });
  ASSERT_TRUE(robot.ok()) << robot.error();
  ASSERT_TRUE((*robot)->send("goal", 60.0).ok());
  EXPECT_GT(turned, geometry::radians(120.0));
  EXPECT_LT(worst, geometry::radians(4.0)) << "wheels and slip are off by 1 % and 0.17 deg/m";
}

}  // namespace
}  // namespace usher::operations
