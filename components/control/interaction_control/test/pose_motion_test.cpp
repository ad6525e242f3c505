#include "control/interaction_control/core/pose_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "control/interaction_control/core/eyes.hpp"

namespace usher::interaction_control {
namespace {

using kinematics::kTorsoJoints;
using kinematics::TorsoPose;
constexpr double kStep = 0.05;

PoseMotion::Parameters parameters() {
  PoseMotion::Parameters p;
  p.limits.fill({-0.5, 0.5, 0.5});
  p.limits[3] = {0.0, 0.08, 0.04};
  return p;
}

TorsoPose craning() { return {0.5, 0.4, -0.2, 0.08, 0.0, 0.1, -0.5}; }

/// Largest change of a joint in a step, as part of its rate; largest change of that.
struct Roughness {
  double rate = 0.0, change = 0.0;
  TorsoPose last{};
  std::array<double, kTorsoJoints> speed{};

  void see(const TorsoPose& pose) {
    for (std::size_t i = 0; i < kTorsoJoints; ++i) {
      const double now = (pose[i] - last[i]) / kStep / parameters().limits[i].rate;
      rate = std::max(rate, std::abs(now));
      change = std::max(change, std::abs(now - speed[i]));
      speed[i] = now;
    }
    last = pose;
  }
};

TEST(PoseMotion, GoesThereSmoothlyAllJointsTogetherWithinTheirRates) {
  PoseMotion motion(parameters());
  motion.start_at({});
  motion.go_to(craning());
  EXPECT_FALSE(motion.arrived());
  Roughness roughness;
  int steps = 0;
  while (!motion.arrived() && steps < 200) {
    const TorsoPose& pose = motion.step(kStep);
    roughness.see(pose);
    ++steps;
    const double share = pose[3] / 0.08;
    for (std::size_t i = 0; i < kTorsoJoints; ++i)
      EXPECT_NEAR(pose[i], share * craning()[i], 1e-9) << "together, " << i;
  }
  EXPECT_EQ(motion.pose(), craning());
  // The neck has the longest way: 0.08 m at 0.8 x 0.04 m/s, 1.875 times as long; and the start.
  EXPECT_NEAR(steps * kStep, 1.875 * 0.08 / 0.032 + 0.1, 0.1);
  EXPECT_LE(roughness.rate, 0.8 + 1e-9);
  EXPECT_GT(roughness.rate, 0.7) << "and does not dawdle";
  EXPECT_LT(roughness.change, 0.1) << "no jerk at either end";
}

TEST(PoseMotion, ANewGoalOnTheWayMakesNoJerkAndNothingOvershoots) {
  PoseMotion motion(parameters());
  motion.start_at({});
  Roughness roughness;
  TorsoPose low{}, high{};
  const TorsoPose goals[] = {craning(), {}, {-0.5, 0.3, 0.2, 0.02, 0, 0, 0.5}, craning()};
  for (int i = 0; i < 400; ++i) {
    motion.go_to(goals[(i / 31) % 4]);
    const TorsoPose& pose = motion.step(kStep);
    roughness.see(pose);
    for (std::size_t j = 0; j < kTorsoJoints; ++j) {
      low[j] = std::min(low[j], pose[j]);
      high[j] = std::max(high[j], pose[j]);
    }
  }
  EXPECT_LE(roughness.rate, 0.8 + 1e-9);
  EXPECT_LT(roughness.change, 0.25) << "from 0.8 of the rate to none in 0.2 s";
  for (std::size_t j = 0; j < kTorsoJoints; ++j) {
    const double lowest = std::min({goals[0][j], goals[1][j], goals[2][j], goals[3][j]});
    const double highest = std::max({goals[0][j], goals[1][j], goals[2][j], goals[3][j]});
    EXPECT_GE(low[j], lowest - 1e-12) << j;
    EXPECT_LE(high[j], highest + 1e-12) << j;
  }
}

TEST(PoseMotion, HoldsStillSoonAndGoesOnAfterwards) {
  PoseMotion motion(parameters());
  motion.start_at({});
  motion.go_to(craning());
  for (int i = 0; i < 40; ++i) motion.step(kStep);
  EXPECT_TRUE(motion.moving());
  motion.hold(true);
  for (int i = 0; i < 5; ++i) motion.step(kStep);  // 0.25 s
  const TorsoPose held = motion.pose();
  EXPECT_FALSE(motion.moving());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(motion.step(kStep), held);
  motion.go_to({});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(motion.step(kStep), held) << "new goals wait, too";
  EXPECT_FALSE(motion.arrived());
  motion.hold(false);
  for (int i = 0; i < 200; ++i) motion.step(kStep);
  EXPECT_EQ(motion.pose(), TorsoPose{});
  EXPECT_TRUE(motion.arrived());
}

TEST(PoseMotion, StandsWhereItStarts) {
  PoseMotion motion(parameters());
  motion.start_at(craning());
  EXPECT_TRUE(motion.arrived());
  EXPECT_EQ(motion.step(kStep), craning());
  EXPECT_FALSE(motion.moving());
  motion.start_at({});
  EXPECT_EQ(motion.step(kStep), TorsoPose{}) << "the old goal is forgotten";
}

TEST(PoseMotion, AJointThatCannotMoveDoesNotStopTheOthers) {
  PoseMotion::Parameters p = parameters();
  p.limits[0] = {};
  PoseMotion motion(p);
  motion.start_at({0.1, 0, 0, 0, 0, 0, 0});
  motion.go_to({0, 0.2, 0, 0, 0, 0, 0});
  for (int i = 0; i < 100; ++i) motion.step(kStep);
  EXPECT_TRUE(motion.arrived());
  EXPECT_EQ(motion.pose()[1], 0.2);
}

TEST(Eyes, FollowTheVoiceAndFadeBetweenColors) {
  Eyes eyes({.silent = 0.4, .fade = 0.5, .blink = 0.1});
  const kinematics::EyeColor green{0.0F, 1.0F, 0.0F}, blue{0.0F, 0.0F, 1.0F};
  for (int i = 0; i < 20; ++i) eyes.step(green, blue, 0.0, kStep);
  EXPECT_FLOAT_EQ(eyes.left()[1], 0.4F);
  EXPECT_FLOAT_EQ(eyes.right()[2], 0.4F);
  eyes.step(green, blue, 0.5, kStep);
  eyes.step(green, blue, 0.5, kStep);
  EXPECT_FLOAT_EQ(eyes.left()[1], 0.7F) << "half of what is left, within 0.1 s";
  eyes.step(green, blue, 7.0, kStep);
  eyes.step(green, blue, 7.0, kStep);
  EXPECT_FLOAT_EQ(eyes.left()[1], 1.0F);
  for (int i = 0; i < 4; ++i) eyes.step(green, blue, std::nan(""), kStep);
  EXPECT_FLOAT_EQ(eyes.left()[1], 0.4F) << "nonsense is silence";
  eyes.step(blue, blue, 0.0, kStep);
  EXPECT_NEAR(eyes.left()[1], 0.4 * 0.9, 1e-6);
  EXPECT_NEAR(eyes.left()[2], 0.4 * 0.1, 1e-6);
  for (int i = 0; i < 10; ++i) eyes.step(blue, blue, 0.0, kStep);
  EXPECT_NEAR(eyes.left()[1], 0.0, 1e-6);
  EXPECT_NEAR(eyes.left()[2], 0.4, 1e-6);
}

}  // namespace
}  // namespace usher::interaction_control
