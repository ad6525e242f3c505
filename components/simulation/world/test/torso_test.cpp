#include "simulation/world/core/torso.hpp"

#include <gtest/gtest.h>

namespace usher::world {
namespace {

kinematics::TorsoLimits limits() {
  kinematics::TorsoLimits limits;
  limits.fill({-0.5, 0.5, 0.4});
  return limits;
}

TEST(Torso, GoesWhereItIsToldAsFastAsItCanAndNoFarther) {
  Torso torso(limits());
  ASSERT_TRUE(torso.exists());
  torso.command({0.2, -0.9, 0, 0, 0, 0, 0}, {1, 0, 2}, {0, 0.5F, 0});
  for (int i = 0; i < 25; ++i) torso.step();
  EXPECT_NEAR(torso.joints()[0], 0.1, 1e-9) << "0.25 s at 0.4 rad/s";
  EXPECT_NEAR(torso.joints()[1], -0.1, 1e-9);
  for (int i = 0; i < 200; ++i) torso.step();
  EXPECT_DOUBLE_EQ(torso.joints()[0], 0.2);
  EXPECT_DOUBLE_EQ(torso.joints()[1], -0.5) << "its stop";
  EXPECT_EQ(torso.left_eye(), (kinematics::EyeColor{1, 0, 1}));
  EXPECT_EQ(torso.right_eye(), (kinematics::EyeColor{0, 0.5F, 0}));
}

TEST(Torso, IsNotThereWhereNothingMoves) {
  Torso torso({});
  EXPECT_FALSE(torso.exists());
  torso.command({1, 1, 1, 1, 1, 1, 1}, {}, {});
  torso.step();
  EXPECT_EQ(torso.joints(), kinematics::TorsoPose{});
}

}  // namespace
}  // namespace usher::world
